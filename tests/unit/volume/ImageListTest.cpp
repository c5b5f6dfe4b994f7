// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of pictures that netpbm and libtiff wrote (files/make_pictures.sh): each format gives the values that
// went in.
#include <gmock/gmock.h>

#include <cstring>

#include "FileCases.h"
#include "vernier/base/Random.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier {
namespace {
using test::bytesOfFile;
using test::has;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path kFiles = fs::path(VERNIER_SOURCE_DIR) / "tests/unit/volume/files";

struct Case {
  test::TempDir dir;
  void copy(const std::string& name, const std::string& as) {
    fs::create_directories((dir.path() / as).parent_path());
    fs::copy_file(kFiles / name, dir.path() / as);
  }
  void write(const std::string& name, const std::string& bytes) {
    std::ofstream(dir.path() / name, std::ios::binary) << bytes;
  }
  Result<std::shared_ptr<const Volume>> read(const std::string& list, const BuildOptions& o = {}) {
    write("list.vrp", list);
    return readVolumeFile((dir.path() / "list.vrp").string(), o);
  }
  ErrorCode refusal(const std::string& list) {
    const auto v = read(list);
    EXPECT_FALSE(v.ok()) << list;
    if (v.ok()) return ErrorCode::Internal;
    EXPECT_GT(v.error().sentence.size(), 20u);
    EXPECT_EQ(v.error().where.find('/'), std::string::npos);
    return v.error().code;
  }
};

double expected(bool deep, std::int64_t x, std::int64_t y) {
  return static_cast<double>(deep ? 9001 * x + 701 * y : 40 * x + 7 * y);
}

TEST(ImageList, EveryFormatGivesTheValuesThatWentIn) {
  for (const bool deep : {false, true}) {
    const std::string n = deep ? "16" : "8";
    for (const std::string& name :
         {"grey" + n + ".png", "grey" + n + "-interlaced.png", "grey" + n + ".tif",
          "grey" + n + "-strips.tif", "grey" + n + "-big-lzw.tif", "grey" + n + "-tiles.tif",
          "grey" + n + ".rgb", "grey" + n + "-rle.rgb"}) {
      SCOPED_TRACE(name);
      Case c;
      c.copy(name, "a");
      const auto v = c.read("a\n");
      ASSERT_TRUE(v.ok()) << v.error().text();
      EXPECT_EQ((*v)->type(), deep ? VoxelType::U16 : VoxelType::U8);
      ASSERT_EQ((*v)->grid().columns, 6);
      ASSERT_EQ((*v)->grid().rows, 5);
      ASSERT_EQ((*v)->grid().slices, 1);
      for (std::int64_t y = 0; y < 5; ++y)
        for (std::int64_t x = 0; x < 6; ++x)
          ASSERT_EQ((*v)->stored(x, y, 0), expected(deep, x, y)) << x << "," << y;
    }
  }
}

TEST(ImageList, LongRunsOfSgi) {
  Case c;
  c.copy("runs.rgb", "a");
  const auto v = c.read("a\n");
  ASSERT_TRUE(v.ok()) << v.error().text();
  ASSERT_EQ((*v)->grid().columns, 300);
  for (std::int64_t x = 0; x < 300; ++x) {
    ASSERT_EQ((*v)->stored(x, 0, 0), x < 200 ? 7 : static_cast<double>(x - 200));
    ASSERT_EQ((*v)->stored(x, 1, 0), 9);
  }
}

// The primer's head: 64 slices with a span of 128 are two units apart; without a span one.
TEST(ImageList, TheSpanPlacesTheSlices) {
  Case c;
  for (int k = 0; k < 4; ++k) c.copy("grey8.rgb", "s" + std::to_string(k) + ".rgb");
  const std::string names = "s0.rgb\r\n  s1.rgb  \n\n# a comment\ns2.rgb\ns3.rgb";
  const auto plain = c.read(names);
  ASSERT_TRUE(plain.ok()) << plain.error().text();
  EXPECT_EQ((*plain)->grid().spacing_mm(), glm::dvec3(1, 1, 1));
  EXPECT_TRUE(has((*plain)->info().findings, "spacing-assumed"));
  EXPECT_TRUE(has((*plain)->info().findings, "axes-unknown"));
  const auto spanned = c.read("@z-span 8\n@pixel-size 0.5 0.75\n@unit HU\n" + names);
  ASSERT_TRUE(spanned.ok()) << spanned.error().text();
  EXPECT_EQ((*spanned)->grid().spacing_mm(), glm::dvec3(0.5, 0.75, 2));
  EXPECT_EQ((*spanned)->info().unit, "HU");
  EXPECT_FALSE(has((*spanned)->info().findings, "spacing-assumed"));
  BuildOptions o;
  o.zSpan = 12;
  const auto asked = c.read(names, o);
  ASSERT_TRUE(asked.ok());
  EXPECT_EQ((*asked)->grid().spacing_mm(), glm::dvec3(1, 1, 3));
  o.zSpan = 1e9;
  EXPECT_EQ(c.read(names, o).error().code, ErrorCode::GeometryRefused);
  EXPECT_EQ(readVolumeFile((kFiles / "int16.nii").string(), o).error().code, ErrorCode::OptionInvalid);
}

TEST(ImageList, SlicesStandInTheOrderOfTheList) {
  Case c;
  c.copy("grey8.png", "z.png");
  std::string sgi = bytesOfFile(kFiles / "grey8.rgb");
  for (std::size_t i = 512; i < sgi.size(); ++i) sgi[i] = static_cast<char>(sgi[i] + 1);
  c.write("a.rgb", sgi);
  const auto v = c.read("z.png\na.rgb\nz.png\n");
  ASSERT_TRUE(v.ok()) << v.error().text();
  for (std::int64_t k = 0; k < 3; ++k) EXPECT_EQ((*v)->stored(2, 3, k), 101 + (k == 1));
}

TEST(ImageList, WhatCannotBeUsedSaysWhy) {
  Case c;
  c.copy("grey8.png", "a.png");
  c.copy("grey16.png", "deep.png");
  c.copy("runs.rgb", "wide.rgb");
  c.copy("palette.png", "palette.png");
  c.copy("colour.rgb", "colour.rgb");
  c.write("text.png", "no picture");
  EXPECT_EQ(c.refusal("a.png\ndeep.png\n"), ErrorCode::FileDamaged);
  EXPECT_EQ(c.refusal("a.png\nwide.rgb\n"), ErrorCode::FileDamaged);
  EXPECT_EQ(c.refusal("a.png\ngone.png\n"), ErrorCode::FileNotFound);
  EXPECT_EQ(c.refusal("a.png\ntext.png\n"), ErrorCode::FormatUnknown);
  EXPECT_EQ(c.refusal("palette.png\n"), ErrorCode::NotBuiltYet);
  EXPECT_EQ(c.refusal("gone.png\na.png\n"), ErrorCode::FormatUnknown)
      << "a text is a list when its first name is a picture";
  for (const char* bad : {"@z-span 0", "@z-span -1", "@z-span nan", "@z-span inf", "@z-span 1 2", "@z-span",
                          "@pixel-size 1", "@zspan 2"})
    EXPECT_EQ(c.refusal(std::string(bad) + "\na.png\n"), ErrorCode::FileDamaged) << bad;
}

TEST(ImageList, NamesThatLeadOutAreRefused) {
  Case c;
  c.copy("grey8.png", "a.png");
  c.copy("grey8.png", "in/a.png");
  fs::create_symlink("../a.png", c.dir.path() / "in/link.png");
  for (const std::string& name :
       {std::string("../a.png"), (c.dir.path() / "a.png").string(), std::string("link.png")}) {
    std::ofstream(c.dir.path() / "in/list.vrp") << "a.png\n" << name << "\n";
    const auto v = readVolumeFile((c.dir.path() / "in/list.vrp").string());
    ASSERT_FALSE(v.ok()) << name;
    EXPECT_THAT(v.error().sentence, HasSubstr("outside its own folder"));
  }
}

TEST(ImageList, DamagedPicturesEndWell) {
  for (const char* name : {"grey16-rle.rgb", "grey8-rle.rgb", "grey16-big-lzw.tif", "grey8-tiles.tif",
                           "grey16-interlaced.png"}) {
    Case c;
    const std::string whole = bytesOfFile(kFiles / name);
    for (std::size_t n = 0; n < whole.size(); n += 3) {
      c.write("a", whole.substr(0, n));
      const auto v = c.read("a\n");
      EXPECT_TRUE(!v.ok() || n + 40 >= whole.size() / 2) << name << " " << n;
    }
    for (std::uint64_t k = 0; k < 600; ++k) {
      std::string bytes = whole;
      bytes[static_cast<std::size_t>(randomUnit(5, k) * static_cast<double>(bytes.size()))] =
          static_cast<char>(256 * randomUnit(6, k));
      c.write("a", bytes);
      (void)c.read("a\n");
    }
  }
}

}  // namespace
}  // namespace vernier
