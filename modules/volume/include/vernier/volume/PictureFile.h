// SPDX-License-Identifier: GPL-3.0-or-later
// One picture file as it stands, for comparisons: PNG, TIFF, SGI; grey, RGB or RGBA of 8 or 16 bits or float,
// never converted. FileNotFound, NotAFile, FormatUnknown, NotBuiltYet (valid, but not read: palettes, several
// pages), FileDamaged, LimitExceeded. Thread-safe.
#pragma once
#include <string>
#include <vector>

#include "vernier/volume/Volume.h"

namespace vernier {

struct PictureFile {
  int width = 0, height = 0;
  int channels = 1;  // 1 grey, 3 RGB, 4 RGBA; interleaved
  VoxelType type = VoxelType::U8;
  bool whiteIsZero = false;
  bool isPng = false;
  std::vector<std::byte> samples;  // native byte order, row 0 on top
};
VERNIER_API Result<PictureFile> readPictureFile(const std::string& path);
// By its first bytes; false for what cannot be opened.
VERNIER_API bool looksLikePicture(const std::string& path);

}  // namespace vernier
