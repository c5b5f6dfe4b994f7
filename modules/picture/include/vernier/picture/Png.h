// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures as PNG. The same picture gives the same bytes on every run: no time and no path inside, and
// of text only what the caller hands in (the measured error, never a value of the patient).
// Reading is for comparisons: 8 bits a channel (grey and palettes are widened to RGB); 16-bit files are
// refused, since they would have to be rounded. Numbers are sRGB-coded as they stand; files that declare
// another gamma are refused. Errors: WriteFailed; FileNotFound, NotAFile, FormatUnknown, FileDamaged,
// LimitExceeded.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "vernier/base/Result.h"
#include "vernier/picture/Picture.h"

namespace vernier {

inline constexpr int kMaxPictureSide = 32768;
inline constexpr std::uint64_t kMaxPicturePixels = 1u << 28;

// A tEXt chunk: keyword of 1 to 79 characters, both in ASCII.
struct PngText {
  std::string keyword, text;
};

VERNIER_API Result<std::vector<std::byte>> encodePng(const Picture&, const std::vector<PngText>& = {});
// Whole or not at all.
VERNIER_API Result<void> writePng(const std::string& path, const Picture&, const std::vector<PngText>& = {});

VERNIER_API Result<Picture> decodePng(std::span<const std::byte> file, const std::string& where = {});
VERNIER_API Result<Picture> readPng(const std::string& path);

}  // namespace vernier
