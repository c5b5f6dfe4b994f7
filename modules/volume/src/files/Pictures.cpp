// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/Pictures.h"

#include <array>
#include <cstring>

namespace vernier {
namespace {

PictureKind kindOf(const InputFilePtr& file) {
  std::array<std::byte, 8> head{};
  return file->read(0, head) ? pictureKindOf(head) : PictureKind::None;
}

Error noPicture() {
  return makeError(ErrorCode::FormatUnknown, "The file is no picture that is read (PNG, TIFF, SGI).");
}

}  // namespace

PictureKind pictureKindOf(std::span<const std::byte> head) {
  const auto begins = [&](const char* text, std::size_t n) {
    return head.size() >= n && std::memcmp(head.data(), text, n) == 0;
  };
  if (begins("\x89PNG\r\n\x1a\n", 8)) return PictureKind::Png;
  if (begins("II*\0", 4) || begins("MM\0*", 4) || begins("II+\0", 4) || begins("MM\0+", 4))
    return PictureKind::Tiff;
  if (begins("\x01\xda", 2) && head.size() > 3 && head[2] <= std::byte{1} &&
      (head[3] == std::byte{1} || head[3] == std::byte{2}))
    return PictureKind::Sgi;
  return PictureKind::None;
}

Result<PictureFacts> pictureFacts(const InputFilePtr& file) {
  switch (kindOf(file)) {
    case PictureKind::Png:
      return pngFacts(file);
    case PictureKind::Tiff:
      return tiffFacts(file);
    case PictureKind::Sgi:
      return sgiFacts(file);
    case PictureKind::None:
      break;
  }
  return noPicture();
}

Result<void> readPicture(const InputFilePtr& file, const PictureFacts& facts, std::span<std::byte> out) {
  switch (kindOf(file)) {
    case PictureKind::Png:
      return readPng(file, facts, out);
    case PictureKind::Tiff:
      return readTiff(file, facts, out);
    case PictureKind::Sgi:
      return readSgi(file, facts, out);
    case PictureKind::None:
      break;
  }
  return noPicture();
}

}  // namespace vernier
