// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/Bricks.h"

#include <gtest/gtest.h>

#include "Grids.h"
#include "vernier/volume/Sampling.h"

namespace vernier {
namespace {

// Brick by brick with plain loops over voxels [b edge, (b + 1) edge], for volumes whose slices don't wander.
void expectPlainLoops(const Volume& v, int edge) {
  const Bricks b = makeBricks(v, edge);
  const GridGeometry& g = v.grid();
  EXPECT_EQ(b.nx, (g.columns + edge - 1) / edge);
  EXPECT_EQ(b.nz, (g.slices + edge - 1) / edge);
  ASSERT_EQ(b.min.size(), std::size_t(b.nx * b.ny * b.nz));
  for (std::int64_t z = 0; z < b.nz; ++z)
    for (std::int64_t y = 0; y < b.ny; ++y)
      for (std::int64_t x = 0; x < b.nx; ++x) {
        double low = INFINITY, high = -INFINITY;
        bool hole = false;
        for (std::int64_t k = z * edge; k <= std::min((z + 1) * edge, g.slices - 1); ++k)
          for (std::int64_t j = y * edge; j <= std::min((y + 1) * edge, g.rows - 1); ++j)
            for (std::int64_t i = x * edge; i <= std::min((x + 1) * edge, g.columns - 1); ++i) {
              if (v.isNoData(v.stored(i, j, k))) {
                hole = true;
                continue;
              }
              low = std::min(low, v.modality(i, j, k));
              high = std::max(high, v.modality(i, j, k));
            }
        const std::size_t at = b.index(x, y, z);
        ASSERT_EQ(b.hasNoData[at] != 0, hole) << x << " " << y << " " << z;
        if (low > high) {
          ASSERT_GT(b.min[at], b.max[at]);
          continue;
        }
        // bounds, and the next float inwards is none
        ASSERT_LE(double(b.min[at]), low);
        ASSERT_GE(double(b.max[at]), high);
        ASSERT_GE(double(std::nextafter(b.min[at], INFINITY)), low);
        ASSERT_LE(double(std::nextafter(b.max[at], -INFINITY)), high);
      }
}

TEST(Bricks, EqualPlainLoops) {
  for (int edge : {1, 4, 8, 64}) {
    VolumeInfo info;
    info.grid = test::unitGrid(21, 17, 9);
    info.rescale = {{0.1, -1024.3}};
    expectPlainLoops(*test::volumeOf(info, test::randomValues<std::int16_t>(21 * 17 * 9, 1, -3000, 3000)),
                     edge);
    info.noData = NoDataRange{-3000, 2000};
    expectPlainLoops(*test::volumeOf(info, test::randomValues<std::int16_t>(21 * 17 * 9, 2, -3000, 3000)),
                     edge);
    info.rescale.clear();
    for (int s = 0; s < 9; ++s) info.rescale.push_back({s - 4.5, 10.0 * s});
    expectPlainLoops(*test::volumeOf(info, test::randomValues<std::uint16_t>(21 * 17 * 9, 3, 0, 3000)), edge);
    info.rescale = {{-2, 1}};
    auto floats = test::randomValues<float>(21 * 17 * 9, 4, -1, 1);
    for (std::size_t i = 0; i < floats.size(); i += 5) floats[i] = std::nanf("");
    for (std::size_t i = 0; i < 21 * 17 * 5; ++i) floats[i] = std::nanf("");
    info.noData.reset();
    expectPlainLoops(*test::volumeOf(info, floats), edge);
  }
}

// Whatever the grid, a sample inside a brick lies within its bounds.
TEST(Bricks, BoundEverySampleOnEveryGrid) {
  for (const test::NamedGrid& named : test::everyGrid()) {
    VolumeInfo info;
    info.grid = named.grid;
    info.noData = NoDataRange{-1000, -700};
    for (glm::dvec3& o : info.grid.sliceOrigin_vox) {  // wander by more than a voxel
      o.x *= 30;
      o.y *= 30;
    }
    const auto v = test::volumeOf(info, test::randomValues<std::int16_t>(7 * 6 * 9, 8, -1000, 1000));
    const Bricks b = makeBricks(*v, 2);
    int seen = 0;
    for (std::uint64_t n = 0; n < 4000; ++n) {
      const GridGeometry& g = v->grid();
      const double x = -0.5 + 7 * randomUnit(1, 3 * n), y = -0.5 + 6 * randomUnit(1, 3 * n + 1);
      const double z = g.firstPosition_vox() - 0.5 +
                       (g.lastPosition_vox() - g.firstPosition_vox() + 1) * randomUnit(1, 3 * n + 2);
      const auto value = sampleModality(*v, g.patientFromVoxel * VoxelPoint(x, y, z));
      std::int64_t k = 0;  // slice at or below z
      while (k + 1 < g.slices && (g.even() ? double(k + 1) : g.sliceOrigin_vox[std::size_t(k + 1)].z) <= z)
        ++k;
      const std::size_t at =
          b.index(std::int64_t(std::max(x, 0.0) / 2), std::int64_t(std::max(y, 0.0) / 2), k / 2);
      if (!value) {
        // no-data is foretold, unless the point left its slices' borders
        if (g.even()) {
          ASSERT_TRUE(b.hasNoData[at]);
        }
        continue;
      }
      ++seen;
      ASSERT_GE(*value, double(b.min[at]) - 1e-9) << named.name;
      ASSERT_LE(*value, double(b.max[at]) + 1e-9) << named.name;
    }
    EXPECT_GT(seen, 1000) << named.name;
  }
}

TEST(Bricks, AGapIsNoData) {
  VolumeInfo info;
  info.grid = test::unitGrid(2, 2, 6);
  for (int s = 0; s < 6; ++s) info.grid.sliceOrigin_vox.push_back({0, 0, s < 4 ? s : s + 3.0});
  info.grid.gapAfter = {3};
  const Bricks b = makeBricks(*test::volumeOf(info, std::vector<std::uint8_t>(24, 1)), 2);
  ASSERT_EQ(b.nz, 3);
  EXPECT_EQ(b.hasNoData[0], 0);
  EXPECT_EQ(b.hasNoData[1], 1);  // slices 2, 3 and 4
  EXPECT_EQ(b.hasNoData[2], 0);
}

}  // namespace
}  // namespace vernier
