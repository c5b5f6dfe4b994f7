// SPDX-License-Identifier: GPL-3.0-or-later
// The SGI image file format, version 1.00 (Paul Haeberli): big endian, channel by channel, rows from the
// bottom up; verbatim or run-length coded.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "files/Pictures.h"

namespace vernier {
namespace {

constexpr std::size_t kHeaderBytes = 512;

std::uint64_t bigEndian(std::span<const std::byte> b, std::size_t at, std::size_t n) {
  std::uint64_t x = 0;
  for (std::size_t i = 0; i < n; ++i) x = x << 8 | std::to_integer<std::uint64_t>(b[at + i]);
  return x;
}

Error damaged() {
  return makeError(ErrorCode::FileDamaged, "The SGI picture is damaged or cut short; fetch the file again.");
}

struct Header {
  PictureFacts facts;
  bool runs = false;
  std::size_t bytesPerSample = 1;
};

Result<Header> headerOf(const InputFile& file) {
  std::array<std::byte, 108> b{};
  if (file.size() < kHeaderBytes || !file.read(0, b)) return damaged();
  Header h;
  h.runs = bigEndian(b, 2, 1) == 1;
  h.bytesPerSample = static_cast<std::size_t>(bigEndian(b, 3, 1));
  const std::uint64_t dimension = bigEndian(b, 4, 2);
  const std::uint64_t x = bigEndian(b, 6, 2), y = dimension > 1 ? bigEndian(b, 8, 2) : 1,
                      z = dimension > 2 ? bigEndian(b, 10, 2) : 1;
  if (dimension < 1 || dimension > 3 || x < 1 || y < 1 || z < 1) return damaged();
  if (z == 2 || z > 4 || bigEndian(b, 104, 4) != 0)
    return makeError(ErrorCode::NotBuiltYet,
                     "SGI pictures of 1 (grey), 3 (RGB) or 4 (RGBA) channels without a colour map are read.");
  h.facts.columns = static_cast<std::int64_t>(x);
  h.facts.rows = static_cast<std::int64_t>(y);
  h.facts.channels = static_cast<int>(z);
  h.facts.type = h.bytesPerSample == 2 ? VoxelType::U16 : VoxelType::U8;
  return h;
}

// One coded row: a count in the low 7 bits of each number, then that many values, or one value that many
// times.
bool expand(std::span<const std::byte> coded, std::size_t width, std::vector<std::byte>& row) {
  const std::size_t wanted = row.size() / width;
  std::size_t at = 0, done = 0;
  while (at + width <= coded.size()) {
    const auto head = bigEndian(coded, at, width);
    at += width;
    const std::size_t n = head & 0x7f;
    if (n == 0) return done == wanted;
    const bool literal = (head & 0x80) != 0;
    if (n > wanted - done || coded.size() - at < (literal ? n * width : width)) return false;
    for (std::size_t i = 0; i < n; ++i)
      std::memcpy(row.data() + (done + i) * width, coded.data() + at + (literal ? i * width : 0), width);
    at += literal ? n * width : width;
    done += n;
  }
  return done == wanted;  // writers leave the closing zero out
}

class Rows {
 public:
  Rows(const InputFile& file, const Header& h) : file_(file), h_(h) {}

  Result<void> begin() {
    if (!h_.runs) return {};
    const std::size_t n =
        static_cast<std::size_t>(h_.facts.rows) * static_cast<std::size_t>(h_.facts.channels);
    if (file_.size() < kHeaderBytes + 8 * n) return damaged();
    table_.resize(8 * n);
    if (!file_.read(kHeaderBytes, table_)) return damaged();
    return {};
  }

  // Row y from the bottom of a channel, still big endian.
  Result<void> read(std::size_t y, std::size_t channel, std::vector<std::byte>& row) {
    const std::size_t n = channel * static_cast<std::size_t>(h_.facts.rows) + y;
    if (!h_.runs) return file_.read(kHeaderBytes + n * row.size(), row) ? Result<void>{} : damaged();
    const std::uint64_t start = bigEndian(table_, 4 * n, 4),
                        bytes = bigEndian(table_, table_.size() / 2 + 4 * n, 4);
    if (bytes > file_.size() || bytes > 4 * row.size() + 16) return damaged();
    coded_.resize(static_cast<std::size_t>(bytes));
    if (!file_.read(start, coded_) || !expand(coded_, h_.bytesPerSample, row)) return damaged();
    return {};
  }

 private:
  const InputFile& file_;
  const Header& h_;
  std::vector<std::byte> table_, coded_;
};

}  // namespace

Result<PictureFacts> sgiFacts(const InputFilePtr& file) {
  const auto h = headerOf(*file);
  if (!h) return h.error();
  return h->facts;
}

Result<void> readSgi(const InputFilePtr& file, const PictureFacts& facts, std::span<std::byte> out) {
  const auto h = headerOf(*file);
  if (!h) return h.error();
  if (h->facts != facts) return damaged();
  Rows rows(*file, *h);
  if (auto r = rows.begin(); !r) return r;
  const std::size_t width = h->bytesPerSample, columns = static_cast<std::size_t>(facts.columns),
                    height = static_cast<std::size_t>(facts.rows),
                    channels = static_cast<std::size_t>(facts.channels);
  std::vector<std::byte> row(columns * width);
  for (std::size_t c = 0; c < channels; ++c)
    for (std::size_t y = 0; y < height; ++y) {
      if (auto r = rows.read(y, c, row); !r) return r;
      std::byte* const to = out.data() + (height - 1 - y) * columns * channels * width + c * width;
      for (std::size_t x = 0; x < columns; ++x)
        for (std::size_t b = 0; b < width; ++b) {
          const bool swap = std::endian::native == std::endian::little;
          to[x * channels * width + b] = row[x * width + (swap ? width - 1 - b : b)];
        }
    }
  return {};
}

}  // namespace vernier
