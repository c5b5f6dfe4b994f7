// SPDX-License-Identifier: GPL-3.0-or-later
// Ranges of bricks, read row by row and by type, against the modality values one by one.
#include "BrickRanges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "Scenes.h"

namespace vernier::quality {
namespace {

constexpr std::int64_t kColumns = 19, kRows = 11, kSlices = 13;

// Values that each type can hold, its ends among them.
template <class T>
std::shared_ptr<const Volume> volumeOf(VoxelType type, std::optional<NoDataRange> noData) {
  VolumeInfo info;
  info.grid = test::gridOf(kColumns, kRows, kSlices);
  info.type = type;
  info.noData = noData;
  info.rescale.clear();
  for (std::int64_t k = 0; k < kSlices; ++k)  // falling slopes, too
    info.rescale.push_back({k % 2 == 0 ? 0.5 + static_cast<double>(k) : -1.25, 3.0 - static_cast<double>(k)});
  auto buffer = Buffer::make(kColumns * kRows * kSlices * sizeof(T));
  auto* const to = reinterpret_cast<T*>(buffer->data());
  std::uint64_t seed = 7;
  for (std::int64_t n = 0; n < kColumns * kRows * kSlices; ++n) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    if constexpr (std::is_same_v<T, float>)
      to[n] =
          seed >> 61 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(seed >> 40) - 8e6f;
    else
      to[n] = static_cast<T>(seed >> 33);
  }
  to[5] = std::numeric_limits<T>::max(), to[6] = std::numeric_limits<T>::lowest();
  auto made = Volume::make(std::move(info), std::move(*buffer));
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().text());
  return *made;
}

void expectRanges(const Volume& v) {
  const BrickRanges ranges(v);
  ASSERT_FALSE(ranges.bricks().empty());
  for (const BrickRanges::Brick& b : ranges.bricks()) {
    LocalRange truth;
    for (std::int64_t k = b.z.first; k <= b.z.last; ++k)
      for (std::int64_t j = b.y.first; j <= b.y.last; ++j)
        for (std::int64_t i = b.x.first; i <= b.x.last; ++i)
          if (!v.isNoData(v.stored(i, j, k))) truth.add(v.modality(i, j, k));
    EXPECT_EQ(b.values.min, truth.min);
    EXPECT_EQ(b.values.max, truth.max);
  }
}

TEST(BrickRanges, AreThoseOfTheModalityValuesForEveryType) {
  for (const auto& noData : {std::optional<NoDataRange>{}, std::optional<NoDataRange>{{-40.0, 90.0}}}) {
    expectRanges(*volumeOf<std::uint8_t>(VoxelType::U8, noData));
    expectRanges(*volumeOf<std::int8_t>(VoxelType::I8, noData));
    expectRanges(*volumeOf<std::uint16_t>(VoxelType::U16, noData));
    expectRanges(*volumeOf<std::int16_t>(VoxelType::I16, noData));
    expectRanges(*volumeOf<std::uint32_t>(VoxelType::U32, noData));
    expectRanges(*volumeOf<std::int32_t>(VoxelType::I32, noData));
    expectRanges(*volumeOf<float>(VoxelType::F32, noData));
  }
}

TEST(BrickRanges, OfNothingButNoDataAreEmpty) {
  const auto v = volumeOf<std::int16_t>(VoxelType::I16, NoDataRange{-1e9, 1e9});
  const BrickRanges ranges(*v);
  for (const BrickRanges::Brick& b : ranges.bricks()) EXPECT_GT(b.values.min, b.values.max);
}

}  // namespace
}  // namespace vernier::quality
