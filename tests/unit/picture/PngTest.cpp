// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Png.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cstring>
#include <fstream>
#include <set>

#include "TestData.h"
#include "vernier/base/Random.h"
#include "vernier/picture/WriteFile.h"

namespace vernier {
namespace {

Picture noise(int w, int h, int channels) {
  Picture p;
  p.width = w, p.height = h, p.channels = channels;
  p.pixels.resize(static_cast<std::size_t>(w * h * channels));
  for (std::size_t i = 0; i < p.pixels.size(); ++i) p.pixels[i] = static_cast<std::uint8_t>(randomBits(3, i));
  return p;
}

TEST(Png, RoundTripIsExact) {
  const test::TempDir dir;
  for (int channels : {3, 4})
    for (auto [w, h] : {std::pair{1, 1}, {1, 7}, {257, 3}, {64, 64}}) {
      const Picture p = noise(w, h, channels);
      const std::string path = (dir.path() / "a.png").string();
      ASSERT_TRUE(writePng(path, p).ok());
      const auto back = readPng(path);
      ASSERT_TRUE(back.ok()) << back.error().text();
      EXPECT_EQ(*back, p);
    }
}

// Another reader's opinion: libpng's simplified interface.
TEST(Png, OthersReadTheSame) {
  const Picture p = noise(31, 17, 3);
  const auto bytes = encodePng(p);
  ASSERT_TRUE(bytes.ok());
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, bytes->data(), bytes->size()));
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  EXPECT_EQ(pixels, p.pixels);
}

TEST(Png, SameBytesEachTimeAndNothingButPixels) {
  const Picture p = noise(40, 30, 3);
  const auto bytes = encodePng(p);
  ASSERT_TRUE(bytes.ok());
  EXPECT_EQ(*bytes, *encodePng(p));
  std::set<std::string> chunks;
  for (std::size_t at = 8; at + 8 <= bytes->size();) {
    const auto* b = reinterpret_cast<const unsigned char*>(bytes->data()) + at;
    chunks.insert(std::string(reinterpret_cast<const char*>(b) + 4, 4));
    at += 12 + ((std::size_t{b[0]} << 24) | (std::size_t{b[1]} << 16) | (std::size_t{b[2]} << 8) | b[3]);
  }
  EXPECT_EQ(chunks, (std::set<std::string>{"IHDR", "IDAT", "IEND"}));
}

TEST(Png, TextIsStoredAsGivenAndThePixelsStay) {
  const Picture p = noise(9, 5, 3);
  const std::string said = "99 % within 0.31 levels of 255";
  const auto bytes = encodePng(p, {{"Software", "vernier"}, {"Error", said}});
  ASSERT_TRUE(bytes.ok());
  const std::string file(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  EXPECT_NE(file.find("tEXtError" + std::string(1, '\0') + said), std::string::npos);
  EXPECT_EQ(*decodePng(*bytes), p);
}

TEST(Png, RefusesWhatItCannotStore) {
  EXPECT_FALSE(encodePng(Picture()).ok());
  Picture p(4, 4);
  p.pixels.pop_back();
  EXPECT_FALSE(encodePng(p).ok());
  Picture wide;
  wide.width = kMaxPictureSide + 1, wide.height = 1;
  EXPECT_FALSE(encodePng(wide).ok());
  const auto e = writePng("/proc/nowhere/a.png", Picture(2, 2));
  ASSERT_FALSE(e.ok());
  EXPECT_EQ(e.error().code, ErrorCode::WriteFailed);
  EXPECT_EQ(e.error().where, "/proc/nowhere/a.png");
}

TEST(Png, DamagedFilesAreErrors) {
  const auto bytes = encodePng(noise(32, 32, 3));
  ASSERT_TRUE(bytes.ok());
  // Cut anywhere: never a crash, never a picture with missing rows.
  for (std::size_t n = 0; n + 12 < bytes->size(); n += 97) {
    const auto cutShort = decodePng(std::span(*bytes).first(n));
    ASSERT_FALSE(cutShort.ok()) << n;
    EXPECT_EQ(cutShort.error().code, n < 8 ? ErrorCode::FormatUnknown : ErrorCode::FileDamaged);
  }
  for (std::size_t n : {20u, 60u, 500u}) {
    std::vector<std::byte> bad = *bytes;
    bad[n] ^= std::byte{0x55};
    EXPECT_FALSE(decodePng(bad).ok()) << "flipped bits at " << n;
  }
}

TEST(Png, WhatIsNoPictureIsSaid) {
  const test::TempDir dir;
  EXPECT_EQ(readPng((dir.path() / "none.png").string()).error().code, ErrorCode::FileNotFound);
  EXPECT_EQ(readPng(dir.path().string()).error().code, ErrorCode::NotAFile);
  EXPECT_EQ(readPng("/dev/zero").error().code, ErrorCode::NotAFile);
  const std::string text = (dir.path() / "text.png").string();
  std::ofstream(text) << "this is no picture";
  EXPECT_EQ(readPng(text).error().code, ErrorCode::FormatUnknown);
}

// A file of another kind, made with libpng itself.
std::vector<std::byte> otherPng(png_uint_32 width, png_uint_32 height, int depth, int colourType,
                                double gamma) {
  struct Out {
    std::vector<std::byte> bytes;
  } out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep data, std::size_t n) {
        auto* o = static_cast<Out*>(png_get_io_ptr(p));
        const auto* b = reinterpret_cast<const std::byte*>(data);
        o->bytes.insert(o->bytes.end(), b, b + n);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, depth, colourType, 0, 0, 0);
  if (gamma > 0) png_set_gAMA(png, info, gamma);
  png_write_info(png, info);
  if (width < 1000) {
    std::vector<png_byte> row(std::size_t{width} * 8, 200);
    for (png_uint_32 y = 0; y < height; ++y) png_write_row(png, row.data());
    png_write_end(png, nullptr);
  } else {  // the start of the pixels is enough: nobody should read on
    for (char c : {'\0', '\0', '\0', '\x9', 'I', 'D', 'A', 'T', '\0'})
      out.bytes.push_back(static_cast<std::byte>(c));
  }
  png_destroy_write_struct(&png, &info);
  return out.bytes;
}

TEST(Png, GreyIsWidenedAndDeepOrOtherGammaRefused) {
  const auto grey = decodePng(otherPng(3, 2, 8, PNG_COLOR_TYPE_GRAY, 0));
  ASSERT_TRUE(grey.ok()) << grey.error().text();
  EXPECT_EQ(*grey, Picture(3, 2, {200, 200, 200}));
  EXPECT_TRUE(decodePng(otherPng(3, 2, 8, PNG_COLOR_TYPE_RGB, 0.45455)).ok());
  EXPECT_EQ(decodePng(otherPng(3, 2, 16, PNG_COLOR_TYPE_RGB, 0)).error().code, ErrorCode::FormatUnknown);
  EXPECT_EQ(decodePng(otherPng(3, 2, 8, PNG_COLOR_TYPE_RGB, 1.0)).error().code, ErrorCode::FormatUnknown);
}

TEST(Png, LimitsHoldBeforeMemoryIsTaken) {
  EXPECT_EQ(decodePng(otherPng(32768, 32768, 8, PNG_COLOR_TYPE_RGB, 0)).error().code,
            ErrorCode::LimitExceeded);
  EXPECT_FALSE(decodePng(otherPng(900000, 1, 8, PNG_COLOR_TYPE_RGB, 0)).ok());
}

}  // namespace
}  // namespace vernier
