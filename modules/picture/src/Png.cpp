// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Png.h"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "vernier/picture/WriteFile.h"

namespace vernier {
namespace {

// libpng leaves by longjmp: between setjmp and its return no object with a destructor may be born. All such
// objects live in these structs, made before.
struct Writer {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<std::byte> out;
  std::vector<PngText> said;
  std::vector<png_text> texts;  // pointing into said
  ~Writer() { png_destroy_write_struct(&png, &info); }
};
struct Reader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::span<const std::byte> in;
  bool tooLarge = false, wrongKind = false, shortOfMemory = false;
  std::string message;
  Picture picture;
  std::vector<png_bytep> rows;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

void append(png_structp png, png_bytep data, std::size_t n) {
  auto* writer = static_cast<Writer*>(png_get_io_ptr(png));
  const auto* bytes = reinterpret_cast<const std::byte*>(data);
  bool full = false;
  try {  // no exception through libpng
    writer->out.insert(writer->out.end(), bytes, bytes + n);
  } catch (...) {
    full = true;
  }
  if (full) png_error(png, "out of memory");
}
void take(png_structp png, png_bytep to, std::size_t n) {
  auto* reader = static_cast<Reader*>(png_get_io_ptr(png));
  if (n > reader->in.size()) png_error(png, "the file ends too early");
  std::memcpy(to, reader->in.data(), n);
  reader->in = reader->in.subspan(n);
}
void keepMessage(png_structp png, png_const_charp message) {
  static_cast<Reader*>(png_get_error_ptr(png))->message = message;
  png_longjmp(png, 1);
}
void silent(png_structp, png_const_charp) {}
void fail(png_structp png, png_const_charp) { png_longjmp(png, 1); }

bool encode(Writer& w, const Picture& picture) {
  if (setjmp(png_jmpbuf(w.png))) return false;
  png_set_write_fn(w.png, &w, append, nullptr);
  png_set_IHDR(w.png, w.info, static_cast<png_uint_32>(picture.width),
               static_cast<png_uint_32>(picture.height), 8,
               picture.channels == 4 ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(w.png, 6);
  if (!w.texts.empty()) png_set_text(w.png, w.info, w.texts.data(), static_cast<int>(w.texts.size()));
  png_write_info(w.png, w.info);
  for (int y = 0; y < picture.height; ++y) png_write_row(w.png, picture.at(0, y));
  png_write_end(w.png, nullptr);
  return true;
}

// Header only; says whether the pixels may be read.
bool readHeader(Reader& r) {
  if (setjmp(png_jmpbuf(r.png))) return false;
  png_set_read_fn(r.png, &r, take);
  png_set_user_limits(r.png, kMaxPictureSide, kMaxPictureSide);
  png_set_chunk_malloc_max(r.png, 8u << 20);
  png_read_info(r.png, r.info);
  const png_uint_32 width = png_get_image_width(r.png, r.info), height = png_get_image_height(r.png, r.info);
  r.tooLarge = static_cast<std::uint64_t>(width) * height > kMaxPicturePixels;
  double gamma = 1 / 2.2;
  png_get_gAMA(r.png, r.info, &gamma);
  r.wrongKind = png_get_bit_depth(r.png, r.info) > 8 || gamma < 0.45 || gamma > 0.46;
  if (r.tooLarge || r.wrongKind) return false;
  png_set_expand(r.png);  // palettes, low bit depths and transparency
  png_set_gray_to_rgb(r.png);
  png_set_interlace_handling(r.png);
  png_read_update_info(r.png, r.info);
  r.picture.width = static_cast<int>(width);
  r.picture.height = static_cast<int>(height);
  r.picture.channels = png_get_channels(r.png, r.info);
  return true;
}
bool readRows(Reader& r) {
  if (setjmp(png_jmpbuf(r.png))) return false;
  png_read_image(r.png, r.rows.data());
  png_read_end(r.png, nullptr);
  return true;
}

void pointAtRows(Picture& picture, std::vector<png_bytep>& rows) {
  rows.resize(static_cast<std::size_t>(picture.height));
  for (int y = 0; y < picture.height; ++y) rows[static_cast<std::size_t>(y)] = picture.at(0, y);
}

}  // namespace

Result<std::vector<std::byte>> encodePng(const Picture& picture, const std::vector<PngText>& texts) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(std::max(picture.width, 0)) *
                               static_cast<std::uint64_t>(std::max(picture.height, 0));
  if (picture.width < 1 || picture.height < 1 || picture.width > kMaxPictureSide ||
      picture.height > kMaxPictureSide || pixels > kMaxPicturePixels ||
      (picture.channels != 3 && picture.channels != 4) ||
      picture.pixels.size() != pixels * static_cast<std::uint64_t>(picture.channels))
    return makeError(ErrorCode::WriteFailed, "A picture of " + std::to_string(picture.width) + " x " +
                                                 std::to_string(picture.height) +
                                                 " pixels cannot be stored as PNG.");
  Writer w;
  w.said = texts;
  for (PngText& t : w.said) {
    png_text text{};
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = t.keyword.data();
    text.text = t.text.data();
    text.text_length = t.text.size();
    w.texts.push_back(text);
  }
  w.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, silent);
  if (w.png) w.info = png_create_info_struct(w.png);
  if (!w.png || !w.info || !encode(w, picture))
    return makeError(ErrorCode::WriteFailed, "The picture cannot be packed as PNG.");
  return std::move(w.out);
}

Result<void> writePng(const std::string& path, const Picture& picture, const std::vector<PngText>& texts) {
  const Result<std::vector<std::byte>> bytes = encodePng(picture, texts);
  if (!bytes) return makeError(bytes.error().code, bytes.error().sentence, path);
  return writeFileWhole(path, *bytes);
}

Result<Picture> decodePng(std::span<const std::byte> file, const std::string& where) {
  if (file.size() < 8 || png_sig_cmp(reinterpret_cast<png_const_bytep>(file.data()), 0, 8) != 0)
    return makeError(ErrorCode::FormatUnknown, "The file is not a PNG picture; give one that Vernier wrote.",
                     where);
  Reader r;
  r.in = file;
  r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &r, keepMessage, silent);
  if (r.png) r.info = png_create_info_struct(r.png);
  if (!r.png || !r.info)
    return makeError(ErrorCode::OutOfMemory, "There is no memory to read the picture.", where);
  const auto damaged = [&] {
    return makeError(ErrorCode::FileDamaged, "The PNG picture is damaged (" + r.message + ").", where);
  };
  if (!readHeader(r)) {
    if (r.tooLarge)
      return makeError(ErrorCode::LimitExceeded,
                       "The picture has more than " + std::to_string(kMaxPicturePixels) + " pixels.", where);
    if (r.wrongKind)
      return makeError(
          ErrorCode::FormatUnknown,
          "The picture does not have 8 bits a channel in sRGB coding, so it cannot be compared exactly.",
          where);
    return damaged();
  }
  r.picture.pixels.resize(static_cast<std::size_t>(r.picture.channels) *
                          static_cast<std::size_t>(r.picture.width) *
                          static_cast<std::size_t>(r.picture.height));
  pointAtRows(r.picture, r.rows);
  if (!readRows(r)) return damaged();
  return std::move(r.picture);
}

Result<Picture> readPng(const std::string& path) {
  std::error_code ec;
  const std::string name = std::filesystem::path(path).filename().string();
  const auto status = std::filesystem::status(path, ec);
  if (!std::filesystem::exists(status))
    return makeError(ErrorCode::FileNotFound, "There is no such file; check the name.", name);
  if (!std::filesystem::is_regular_file(status))
    return makeError(ErrorCode::NotAFile, "This is not a file; give a PNG picture.", name);
  const std::uintmax_t size = std::filesystem::file_size(path, ec);
  if (ec || size > 4 * kMaxPicturePixels)
    return makeError(ErrorCode::LimitExceeded, "The file is too large for a picture.", name);
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  std::ifstream in(path, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) return makeError(ErrorCode::FileNotFound, "The file cannot be read.", name);
  return decodePng(bytes, name);
}

}  // namespace vernier
