// SPDX-License-Identifier: GPL-3.0-or-later
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>
#include <vector>

#include "files/Pictures.h"

namespace vernier {
namespace {

constexpr png_uint_32 kMostPixels = 65535;

// What the callbacks of libpng share. libpng reports errors by longjmp, which must not pass over objects with
// destructors: the functions below that call it hold none.
struct State {
  const InputFile* file = nullptr;
  std::uint64_t at = 0;
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~State() { png_destroy_read_struct(&png, &info, nullptr); }
};

void give(png_structp png, png_bytep to, std::size_t n) {
  State& s = *static_cast<State*>(png_get_io_ptr(png));
  if (!s.file->read(s.at, std::as_writable_bytes(std::span(to, n)))) png_error(png, "the file ends early");
  s.at += n;
}

bool open(State& s) {
  s.png = png_create_read_struct(
      PNG_LIBPNG_VER_STRING, nullptr, [](png_structp p, png_const_charp) { png_longjmp(p, 1); },
      [](png_structp, png_const_charp) {});
  if (!s.png) return false;
  s.info = png_create_info_struct(s.png);
  if (!s.info) return false;
  png_set_read_fn(s.png, &s, give);
  png_set_user_limits(s.png, kMostPixels, kMostPixels);
  png_set_chunk_cache_max(s.png, 64);
  png_set_chunk_malloc_max(s.png, 8 << 20);
  png_set_crc_action(s.png, PNG_CRC_ERROR_QUIT, PNG_CRC_WARN_DISCARD);
  return true;
}

bool readHeader(State& s) {
  if (setjmp(png_jmpbuf(s.png))) return false;
  png_read_info(s.png, s.info);
  return true;
}

bool readRows(State& s, png_bytepp rows) {
  if (setjmp(png_jmpbuf(s.png))) return false;
  if constexpr (std::endian::native == std::endian::little)
    if (png_get_bit_depth(s.png, s.info) == 16) png_set_swap(s.png);
  png_set_interlace_handling(s.png);
  png_read_image(s.png, rows);
  png_read_end(s.png, nullptr);
  return true;
}

Error damaged() {
  return makeError(ErrorCode::FileDamaged, "The PNG picture is damaged; fetch the file again.");
}

Result<PictureFacts> factsOf(const State& s) {
  PictureFacts f;
  f.columns = png_get_image_width(s.png, s.info);
  f.rows = png_get_image_height(s.png, s.info);
  const int depth = png_get_bit_depth(s.png, s.info), colour = png_get_color_type(s.png, s.info);
  if (depth < 8 || colour == PNG_COLOR_TYPE_PALETTE)
    return makeError(
        ErrorCode::NotBuiltYet,
        "PNG pictures with a palette or fewer than 8 bits are not read; save them as grey of 8 or 16 bits.");
  if (colour == PNG_COLOR_TYPE_GRAY_ALPHA)
    return makeError(ErrorCode::NotBuiltYet,
                     "PNG pictures of grey with alpha are not read; save them without alpha.");
  f.channels = colour == PNG_COLOR_TYPE_RGB ? 3 : colour == PNG_COLOR_TYPE_RGB_ALPHA ? 4 : 1;
  f.type = depth == 16 ? VoxelType::U16 : VoxelType::U8;
  return f;
}

}  // namespace

Result<PictureFacts> pngFacts(const InputFilePtr& file) {
  State s;
  s.file = file.get();
  if (!open(s) || !readHeader(s)) return damaged();
  return factsOf(s);
}

Result<void> readPng(const InputFilePtr& file, const PictureFacts& facts, std::span<std::byte> out) {
  State s;
  s.file = file.get();
  if (!open(s) || !readHeader(s)) return damaged();
  const auto now = factsOf(s);
  if (!now) return now.error();
  const std::size_t rowBytes = out.size() / static_cast<std::size_t>(facts.rows);
  if (*now != facts || png_get_rowbytes(s.png, s.info) != rowBytes) return damaged();
  std::vector<png_bytep> rows(static_cast<std::size_t>(facts.rows));
  for (std::size_t y = 0; y < rows.size(); ++y)
    rows[y] = reinterpret_cast<png_bytep>(out.data() + y * rowBytes);
  if (!readRows(s, rows.data())) return damaged();
  return {};
}

}  // namespace vernier
