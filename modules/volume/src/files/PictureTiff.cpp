// SPDX-License-Identifier: GPL-3.0-or-later
#include <tiffio.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "files/Pictures.h"

namespace vernier {
namespace {

constexpr tmsize_t kMostAllocation = tmsize_t{1} << 30;
constexpr std::uint32_t kMostPixels = 65535;

struct Stream {
  const InputFile* file;
  std::uint64_t at = 0;
};

tmsize_t give(thandle_t user, void* to, tmsize_t n) {
  Stream& s = *static_cast<Stream*>(user);
  const std::uint64_t left = s.file->size() - std::min(s.at, s.file->size());
  const std::uint64_t now =
      std::min<std::uint64_t>(left, static_cast<std::uint64_t>(std::max<tmsize_t>(n, 0)));
  if (!s.file->read(s.at, {static_cast<std::byte*>(to), static_cast<std::size_t>(now)})) return 0;
  s.at += now;
  return static_cast<tmsize_t>(now);
}
toff_t seek(thandle_t user, toff_t offset, int whence) {
  Stream& s = *static_cast<Stream*>(user);
  s.at = whence == SEEK_SET ? offset : whence == SEEK_CUR ? s.at + offset : s.file->size() + offset;
  return s.at;
}
int quiet(TIFF*, void*, const char*, const char*, va_list) { return 1; }

struct Close {
  void operator()(TIFF* t) const { TIFFClose(t); }
};
using Tiff = std::unique_ptr<TIFF, Close>;

Tiff open(Stream& s) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                 &TIFFOpenOptionsFree);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), kMostAllocation);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), quiet, nullptr);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), quiet, nullptr);
  return Tiff(TIFFClientOpenExt(
      "picture", "rm", &s, give, [](thandle_t, void*, tmsize_t) -> tmsize_t { return 0; }, seek,
      [](thandle_t) { return 0; },
      [](thandle_t user) -> toff_t { return static_cast<Stream*>(user)->file->size(); }, nullptr, nullptr,
      options.get()));
}

Error damaged() {
  return makeError(ErrorCode::FileDamaged, "The TIFF picture is damaged; fetch the file again.");
}
Error notRead(const char* what) {
  return makeError(
      ErrorCode::NotBuiltYet,
      std::string("TIFF pictures ") + what +
          " are not read; save them as grey of 8 or 16 bits or as RGB of 8 bits, one picture per file.");
}

template <class T>
T field(TIFF* t, std::uint32_t tag, T otherwise) {
  T x = otherwise;
  return TIFFGetFieldDefaulted(t, tag, &x) == 1 ? x : otherwise;
}

Result<VoxelType> typeOf(TIFF* t) {
  const auto bits = field<std::uint16_t>(t, TIFFTAG_BITSPERSAMPLE, 1);
  const auto format = field<std::uint16_t>(t, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  if (format == SAMPLEFORMAT_IEEEFP && bits == 32) return VoxelType::F32;
  const bool isSigned = format == SAMPLEFORMAT_INT;
  if (format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_VOID || isSigned) {
    if (bits == 8) return isSigned ? VoxelType::I8 : VoxelType::U8;
    if (bits == 16) return isSigned ? VoxelType::I16 : VoxelType::U16;
  }
  return notRead("of this number of bits");
}

// What a fourth value is must be said, and opacity must not have gone into the colours already.
Result<void> checkAlpha(TIFF* t) {
  std::uint16_t n = 0, *kinds = nullptr;
  if (TIFFGetFieldDefaulted(t, TIFFTAG_EXTRASAMPLES, &n, &kinds) == 1 && n == 1) {
    if (kinds[0] == EXTRASAMPLE_UNASSALPHA) return {};
    if (kinds[0] == EXTRASAMPLE_ASSOCALPHA) return notRead("whose colours are multiplied by their opacity");
  }
  return notRead("whose fourth value is not said to be opacity");
}

Result<PictureFacts> factsOf(TIFF* t) {
  PictureFacts f;
  const auto columns = field<std::uint32_t>(t, TIFFTAG_IMAGEWIDTH, 0),
             rows = field<std::uint32_t>(t, TIFFTAG_IMAGELENGTH, 0);
  if (columns < 1 || rows < 1 || columns > kMostPixels || rows > kMostPixels) return damaged();
  f.columns = columns;
  f.rows = rows;
  const auto type = typeOf(t);
  if (!type) return type.error();
  f.type = *type;
  const auto samples = field<std::uint16_t>(t, TIFFTAG_SAMPLESPERPIXEL, 1);
  std::uint16_t photometric = PHOTOMETRIC_MINISBLACK;
  TIFFGetField(t, TIFFTAG_PHOTOMETRIC, &photometric);
  const bool grey = photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_MINISWHITE;
  if (!(grey && samples == 1) && !(photometric == PHOTOMETRIC_RGB && (samples == 3 || samples == 4)))
    return notRead("of this kind of colour");
  if (samples > 1 &&
      field<std::uint16_t>(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) != PLANARCONFIG_CONTIG)
    return notRead("whose colours stand in separate planes");
  if (samples == 4)
    if (auto r = checkAlpha(t); !r) return r.error();
  f.channels = samples;
  f.whiteIsZero = photometric == PHOTOMETRIC_MINISWHITE;
  if (!TIFFIsCODECConfigured(field<std::uint16_t>(t, TIFFTAG_COMPRESSION, COMPRESSION_NONE)))
    return notRead("of this compression");
  if (field<std::uint16_t>(t, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT) != ORIENTATION_TOPLEFT)
    return notRead("that ask to be turned (Orientation)");
  if (!TIFFLastDirectory(t)) return notRead("of several pages");
  return f;
}

Result<void> readTiles(TIFF* t, const PictureFacts& f, std::span<std::byte> out) {
  const auto w = field<std::uint32_t>(t, TIFFTAG_TILEWIDTH, 0),
             h = field<std::uint32_t>(t, TIFFTAG_TILELENGTH, 0);
  const std::size_t pixel = bytesOf(f.type) * static_cast<std::size_t>(f.channels);
  const tmsize_t tileBytes = TIFFTileSize(t);
  if (w < 1 || h < 1 || tileBytes < 1 ||
      static_cast<std::uint64_t>(tileBytes) != std::uint64_t{w} * h * pixel || tileBytes > kMostAllocation)
    return damaged();
  std::vector<std::byte> tile(static_cast<std::size_t>(tileBytes));
  const auto columns = static_cast<std::uint32_t>(f.columns), rows = static_cast<std::uint32_t>(f.rows);
  for (std::uint32_t y = 0; y < rows; y += h)
    for (std::uint32_t x = 0; x < columns; x += w) {
      if (TIFFReadTile(t, tile.data(), x, y, 0, 0) != tileBytes) return damaged();
      const std::size_t n = std::min(w, columns - x) * pixel;
      for (std::uint32_t r = 0; r < std::min(h, rows - y); ++r)
        std::memcpy(out.data() + (std::size_t{y + r} * columns + x) * pixel,
                    tile.data() + std::size_t{r} * w * pixel, n);
    }
  return {};
}

Result<void> readStrips(TIFF* t, const PictureFacts& f, std::span<std::byte> out) {
  const std::size_t rowBytes = out.size() / static_cast<std::size_t>(f.rows);
  if (TIFFScanlineSize(t) != static_cast<tmsize_t>(rowBytes)) return damaged();
  for (std::uint32_t y = 0; y < static_cast<std::uint32_t>(f.rows); ++y)
    if (TIFFReadScanline(t, out.data() + y * rowBytes, y, 0) != 1) return damaged();
  return {};
}

}  // namespace

Result<PictureFacts> tiffFacts(const InputFilePtr& file) {
  Stream s{file.get()};
  const Tiff t = open(s);
  if (!t) return damaged();
  return factsOf(t.get());
}

Result<void> readTiff(const InputFilePtr& file, const PictureFacts& facts, std::span<std::byte> out) {
  Stream s{file.get()};
  const Tiff t = open(s);
  if (!t) return damaged();
  const auto now = factsOf(t.get());
  if (!now) return now.error();
  if (*now != facts) return damaged();
  return TIFFIsTiled(t.get()) ? readTiles(t.get(), facts, out) : readStrips(t.get(), facts, out);
}

}  // namespace vernier
