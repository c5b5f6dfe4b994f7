// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/PictureFile.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "files/Pictures.h"

namespace vernier {
namespace {

constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 30;

FileRecord recordFor(const std::string& path) {
  FileRecord r;
  r.path = path;
  r.shown = std::filesystem::path(path).filename().string();
  return r;
}

PictureKind kindOf(const InputFile& file) {
  std::array<std::byte, 8> head{};
  const std::size_t n = std::min<std::uint64_t>(head.size(), file.size());
  return file.read(0, std::span(head).first(n)) ? pictureKindOf(std::span(head).first(n)) : PictureKind::None;
}

}  // namespace

bool looksLikePicture(const std::string& path) {
  const auto file = openInput(recordFor(path));
  return file && kindOf(**file) != PictureKind::None;
}

Result<PictureFile> readPictureFile(const std::string& path) {
  const FileRecord record = recordFor(path);
  const auto located = [&](Error e) {
    if (e.where.empty()) e.where = record.shown;
    return e;
  };
  const auto file = openInput(record);
  if (!file) return located(file.error());
  const Result<PictureFacts> facts = pictureFacts(*file);
  if (!facts) return located(facts.error());
  PictureFile p;
  const std::uint64_t samples = static_cast<std::uint64_t>(facts->columns) *
                                static_cast<std::uint64_t>(facts->rows) *
                                static_cast<std::uint64_t>(facts->channels);
  if (samples > kMaxSamples)
    return makeError(ErrorCode::LimitExceeded, "The picture has more than 2^30 samples.", record.shown);
  p.width = static_cast<int>(facts->columns), p.height = static_cast<int>(facts->rows);
  p.channels = facts->channels, p.type = facts->type, p.whiteIsZero = facts->whiteIsZero;
  p.isPng = kindOf(**file) == PictureKind::Png;
  p.samples.resize(samples * bytesOf(p.type));
  if (const Result<void> r = readPicture(*file, *facts, p.samples); !r) return located(r.error());
  return p;
}

}  // namespace vernier
