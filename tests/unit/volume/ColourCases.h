// SPDX-License-Identifier: GPL-3.0-or-later
// A small volume of colours that tests of volume files write byte by byte, and its truth.
#pragma once
#include <zlib.h>

#include <array>
#include <cstring>

#include "FileCases.h"
#include "vernier/volume/ImageFrame.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier::test {

inline constexpr int kColumns = 5, kRows = 4, kSlices = 3;
using Rgba = std::array<std::uint8_t, 4>;

// No two channels, and no two axes in a channel, rise alike.
inline std::uint8_t truth(int c, int i, int j, int k) {
  const int v[] = {20 * i + j, 60 * j + k, 100 * k + 3 * i, 255 - 40 * i - j};
  return static_cast<std::uint8_t>(v[c]);
}

// Columns fastest, the values of a voxel beside each other; of one slice where `only` names it.
inline std::string interleaved(int channels, int only = -1) {
  std::string s;
  for (int k = 0; k < kSlices; ++k)
    for (int j = 0; j < kRows; ++j)
      for (int i = 0; i < kColumns; ++i)
        for (int c = 0; c < channels; ++c)
          if (only < 0 || only == k) s.push_back(static_cast<char>(truth(c, i, j, k)));
  return s;
}

inline void expectTruth(const Result<std::shared_ptr<const Volume>>& read, int channels) {
  ASSERT_TRUE(read.ok()) << read.error().text();
  const Volume& v = **read;
  ASSERT_TRUE(v.isColour());
  ASSERT_EQ(v.info().channels, channels);
  ASSERT_EQ(v.grid().columns, kColumns);
  ASSERT_EQ(v.grid().rows, kRows);
  ASSERT_EQ(v.grid().slices, kSlices);
  EXPECT_EQ(v.info().unit, "colour");
  for (int k = 0; k < kSlices; ++k)
    for (int j = 0; j < kRows; ++j)
      for (int i = 0; i < kColumns; ++i) {
        const Rgba want{truth(0, i, j, k), truth(1, i, j, k), truth(2, i, j, k),
                        channels == 4 ? truth(3, i, j, k) : std::uint8_t{255}};
        ASSERT_EQ(v.rgba(i, j, k), want) << i << "," << j << "," << k;
      }
}

template <class T>
void put(std::string& s, std::size_t at, T x) {
  std::memcpy(s.data() + at, &x, sizeof x);
}

inline std::string big(std::uint32_t x, int bytes = 4) {
  std::string s;
  for (int b = bytes - 1; b >= 0; --b) s.push_back(static_cast<char>(x >> (8 * b)));
  return s;
}

inline std::string deflated(const std::string& raw, int windowBits = 15) {
  z_stream z{};
  EXPECT_EQ(deflateInit2(&z, 9, Z_DEFLATED, windowBits, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(raw.size() + 1000, '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(raw.data()));
  z.avail_in = static_cast<uInt>(raw.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&z, Z_FINISH), Z_STREAM_END);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}
inline constexpr int kGzipBits = 15 + 16;

struct Folder {
  test::TempDir dir;
  void write(const std::string& name, const std::string& bytes) {
    std::ofstream(dir.path() / name, std::ios::binary) << bytes;
  }
  Result<std::shared_ptr<const Volume>> read(const std::string& name, const BuildOptions& o = {}) {
    return readVolumeFile((dir.path() / name).string(), o);
  }
  Result<std::shared_ptr<const Volume>> read(const std::string& name, const std::string& bytes) {
    write(name, bytes);
    return read(name);
  }
  Error refusal(const std::string& name, const std::string& bytes) {
    const auto v = read(name, bytes);
    EXPECT_FALSE(v.ok()) << name;
    if (v.ok()) return makeError(ErrorCode::Internal, "It was read.");
    EXPECT_EQ(v.error().where.find('/'), std::string::npos);
    return v.error();
  }
};

}  // namespace vernier::test
