// SPDX-License-Identifier: GPL-3.0-or-later
// Single pictures of a list: PNG (libpng), TIFF (libtiff), SGI (.rgb; own reader). Thread-safe.
#pragma once
#include <span>

#include "files/Streams.h"
#include "vernier/volume/Volume.h"

namespace vernier {

struct PictureFacts {
  std::int64_t columns = 0, rows = 0;
  int channels = 1;                // 1 grey, 3 RGB, 4 RGBA
  VoxelType type = VoxelType::U8;  // U8, I8, U16, I16 or F32
  bool whiteIsZero = false;        // 0 is white (TIFF)
  friend bool operator==(const PictureFacts&, const PictureFacts&) = default;
};

enum class PictureKind { None, Png, Tiff, Sgi };
PictureKind pictureKindOf(std::span<const std::byte> head);

// Size and type from the header. FormatUnknown when it is no picture, NotBuiltYet for what is valid but not
// read (palettes, fewer than 8 bits, several pages), FileDamaged.
Result<PictureFacts> pictureFacts(const InputFilePtr&);
// Samples interleaved by pixel in native byte order, row 0 on top; `out` has exactly the bytes that `facts`
// ask for.
Result<void> readPicture(const InputFilePtr&, const PictureFacts& facts, std::span<std::byte> out);

// Each format, once pictureKindOf has known it.
Result<PictureFacts> pngFacts(const InputFilePtr&);
Result<void> readPng(const InputFilePtr&, const PictureFacts&, std::span<std::byte> out);
Result<PictureFacts> tiffFacts(const InputFilePtr&);
Result<void> readTiff(const InputFilePtr&, const PictureFacts&, std::span<std::byte> out);
Result<PictureFacts> sgiFacts(const InputFilePtr&);
Result<void> readSgi(const InputFilePtr&, const PictureFacts&, std::span<std::byte> out);

}  // namespace vernier
