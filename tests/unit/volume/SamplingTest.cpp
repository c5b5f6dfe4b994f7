// SPDX-License-Identifier: GPL-3.0-or-later
// Against a brute force in long double that shares nothing with the room: it inverts the matrix by Cramer's
// rule and asks every voxel of the volume for its weight (a product of hat functions) instead of looking for
// neighbours.
#include "vernier/volume/Sampling.h"

#include <gtest/gtest.h>

#include "Grids.h"

namespace vernier {
namespace {
using test::unitGrid;
using test::volumeOf;
using Real = long double;

struct Real3 {
  Real x, y, z;
};

Real det(Real3 a, Real3 b, Real3 c) {
  return a.x * (b.y * c.z - b.z * c.y) - b.x * (a.y * c.z - a.z * c.y) + c.x * (a.y * b.z - a.z * b.y);
}
Real3 real(glm::dvec3 v) { return {v.x, v.y, v.z}; }

Real3 voxelOf(const GridGeometry& g, PatientPoint p) {
  const Real3 a = real(g.patientFromVoxel.linear[0]), b = real(g.patientFromVoxel.linear[1]),
              c = real(g.patientFromVoxel.linear[2]), t = real(g.patientFromVoxel.translation);
  const Real3 r{p.p.x - t.x, p.p.y - t.y, p.p.z - t.z};
  const Real d = det(a, b, c);
  return {det(r, b, c) / d, det(a, r, c) / d, det(a, b, r) / d};
}

// Weight of index i along an axis of n for a position x: hat function, the ends held for half a voxel; 0
// outside.
Real hat(Real x, std::int64_t i, std::int64_t n) {
  if (x < -0.5L || x > n - 0.5L) return 0;
  x = std::min(std::max(x, Real(0)), Real(n - 1));
  return std::max(Real(0), 1 - std::fabs(x - i));
}

bool gapAfter(const GridGeometry& g, std::int64_t s) {
  for (std::int64_t x : g.gapAfter)
    if (x == s) return true;
  return false;
}

// Weight of slice k for a position z among slices at origins o.
Real sliceWeight(const GridGeometry& g, Real z, std::int64_t k) {
  const auto at = [&](std::int64_t s) -> Real {
    return g.even() ? Real(s) : Real(g.sliceOrigin_vox[std::size_t(s)].z);
  };
  const Real d = z - at(k);
  if (d == 0) return 1;
  const bool up = d > 0;
  const std::int64_t other = up ? k + 1 : k - 1;
  const bool open = other < 0 || other >= g.slices || gapAfter(g, up ? k : other);
  if (open) return std::fabs(d) <= 0.5L ? 1 : 0;
  const Real step = std::fabs(at(other) - at(k));
  return std::max(Real(0), 1 - std::fabs(d) / step);
}

std::optional<double> brute(const Volume& v, PatientPoint p) {
  const GridGeometry& g = v.grid();
  const Real3 x = voxelOf(g, p);
  Real weight = 0, value = 0;
  for (std::int64_t k = 0; k < g.slices; ++k) {
    const Real wz = sliceWeight(g, x.z, k);
    const glm::dvec3 o = g.even() ? glm::dvec3(0) : g.sliceOrigin_vox[std::size_t(k)];
    for (std::int64_t j = 0; j < g.rows; ++j)
      for (std::int64_t i = 0; i < g.columns; ++i) {
        const Real w = wz * hat(x.x - o.x, i, g.columns) * hat(x.y - o.y, j, g.rows);
        const double s = v.stored(i, j, k);
        if (w <= 0 || v.isNoData(s)) continue;
        weight += w;
        value += w * (Real(v.rescaleOf(k).slope) * s + v.rescaleOf(k).intercept);
      }
  }
  if (weight <= 0) return std::nullopt;
  return double(value / weight);
}

// A point so near to a border that rounding decides is no test of the rule.
bool nearBorder(const GridGeometry& g, PatientPoint p) {
  const Real3 x = voxelOf(g, p);
  const auto near = [](Real a, Real b) { return std::fabs(a - b) < 1e-7L; };
  for (std::int64_t k = 0; k < g.slices; ++k) {
    const glm::dvec3 o = g.even() ? glm::dvec3(0, 0, double(k)) : g.sliceOrigin_vox[std::size_t(k)];
    if (near(x.x - o.x, -0.5L) || near(x.x - o.x, g.columns - 0.5L) || near(x.y - o.y, -0.5L) ||
        near(x.y - o.y, g.rows - 0.5L) || near(std::fabs(x.z - o.z), 0.5L))
      return true;
  }
  return false;
}

PatientPoint randomPoint(const GridGeometry& g, std::uint64_t n) {
  const auto u = [&](std::uint64_t axis) { return randomUnit(77, 3 * n + axis); };
  return g.patientFromVoxel *
         VoxelPoint(
             -1.2 + u(0) * (double(g.columns) + 1.4), -1.2 + u(1) * (double(g.rows) + 1.4),
             g.firstPosition_vox() - 1.2 + u(2) * (g.lastPosition_vox() - g.firstPosition_vox() + 2.4));
}

TEST(Sampling, EqualsBruteForceOnEveryGrid) {
  for (const test::NamedGrid& named : test::everyGrid()) {
    for (const bool padded : {false, true}) {
      VolumeInfo info;
      info.grid = named.grid;
      info.rescale = {{0.37, -1024}};
      if (padded) {
        info.noData = NoDataRange{-2000, -900};
        info.rescale.clear();
        for (int s = 0; s < 9; ++s) info.rescale.push_back({0.1 + 0.3 * s, 5.0 - s});
      }
      const auto v = volumeOf(info, test::randomValues<std::int16_t>(7 * 6 * 9, 5, -2000, 2000));
      ASSERT_TRUE(v);
      int inside = 0, outside = 0;
      for (std::uint64_t n = 0; n < 1500; ++n) {
        const PatientPoint p = randomPoint(named.grid, n);
        if (nearBorder(named.grid, p)) continue;
        const auto got = sampleModality(*v, p), expected = brute(*v, p);
        ASSERT_EQ(got.has_value(), expected.has_value()) << named.name << " " << n;
        ++(got ? inside : outside);
        if (got) {
          ASSERT_NEAR(*got, *expected, 1e-8) << named.name << " " << n;
        }
      }
      EXPECT_GT(inside, 500) << named.name;
      EXPECT_GT(outside, 200) << named.name;
    }
  }
}

// Nearest is the voxel with the greatest weight.
TEST(Sampling, NearestIsTheVoxelOfGreatestWeight) {
  for (const test::NamedGrid& named : test::everyGrid()) {
    VolumeInfo info;
    info.grid = named.grid;
    info.noData = NoDataRange{-2000, -1500};
    const auto v = volumeOf(info, test::randomValues<std::int16_t>(7 * 6 * 9, 6, -2000, 2000));
    int found = 0;
    for (std::uint64_t n = 0; n < 600; ++n) {
      const PatientPoint p = randomPoint(named.grid, n);
      if (nearBorder(named.grid, p)) continue;
      const Real3 x = voxelOf(named.grid, p);
      Real bestZ = 0;
      std::int64_t k = -1;
      for (std::int64_t s = 0; s < named.grid.slices; ++s)
        if (sliceWeight(named.grid, x.z, s) > bestZ) bestZ = sliceWeight(named.grid, x.z, s), k = s;
      Real best = 0;
      std::int64_t bi = 0, bj = 0;
      if (k >= 0) {
        const glm::dvec3 o = named.grid.even() ? glm::dvec3(0) : named.grid.sliceOrigin_vox[std::size_t(k)];
        for (std::int64_t j = 0; j < 6; ++j)
          for (std::int64_t i = 0; i < 7; ++i) {
            const Real w = hat(x.x - o.x, i, 7) * hat(x.y - o.y, j, 6);
            if (w > best) best = w, bi = i, bj = j;
          }
      }
      const auto probe = probeStored(*v, p);
      const auto nearest = sampleModality(*v, p, Interpolation::Nearest);
      ASSERT_EQ(probe.has_value(), best > 0) << named.name << " " << n;
      if (!probe) {
        ASSERT_FALSE(nearest);
        continue;
      }
      ++found;
      ASSERT_EQ(std::tuple(probe->i, probe->j, probe->k), std::tuple(bi, bj, k)) << named.name << " " << n;
      ASSERT_EQ(probe->stored, v->stored(bi, bj, k));
      ASSERT_EQ(nearest.has_value(), !v->isNoData(probe->stored));
      if (nearest) {
        ASSERT_EQ(*nearest, probe->modality);
      }
    }
    EXPECT_GT(found, 100) << named.name;
  }
}

TEST(Sampling, VoxelCentresGiveTheVoxelExactly) {
  VolumeInfo info;
  info.grid = unitGrid(5, 4, 3);
  info.rescale = {{2.5, -1000}};
  const auto values = test::randomValues<std::int16_t>(60, 1, -1000, 1000);
  const auto v = volumeOf(info, values);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i)
        EXPECT_EQ(*sampleModality(*v, PatientPoint(i, j, k)),
                  2.5 * values[std::size_t(i + 5 * (j + 4 * k))] - 1000);
}

TEST(Sampling, BorderIsHeldForHalfAVoxelAndRoundingIsForgiven) {
  VolumeInfo info;
  info.grid = unitGrid(2, 2, 2);
  const auto v = volumeOf(info, std::vector<std::int16_t>{0, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(*sampleModality(*v, PatientPoint(-0.5, 0, 0)), 0);
  EXPECT_EQ(*sampleModality(*v, PatientPoint(1.5, 1.5, 1.5)), 7);
  for (double e : {7e-15, 9e-10}) {
    EXPECT_EQ(sampleModality(*v, PatientPoint(0, 0, 0 - 0.5 - e)), 0);
    EXPECT_EQ(sampleModality(*v, PatientPoint(0, 0, 1.5 + e)), 4);
    EXPECT_EQ(sampleModality(*v, PatientPoint(1.5 + e, 0, 0)), 1);
  }
  for (double e : {1e-8, 0.1}) {
    EXPECT_FALSE(sampleModality(*v, PatientPoint(0, 0, -0.5 - e)));
    EXPECT_FALSE(sampleModality(*v, PatientPoint(0, 0, 1.5 + e)));
    EXPECT_FALSE(sampleModality(*v, PatientPoint(-0.5 - e, 0, 0)));
    EXPECT_FALSE(sampleModality(*v, PatientPoint(0, 1.5 + e, 0)));
  }
  EXPECT_FALSE(sampleModality(*v, PatientPoint(std::nan(""), 0, 0)));
  EXPECT_FALSE(sampleModality(*v, PatientPoint(0, 0, INFINITY)));
}

// By hand: a square of four voxels, one of them padding. At its middle the three others weigh one third each;
// at (0.25, 0.25) the weights are 9/16, 3/16, 3/16, 1/16, and without the last they sum to 15/16.
TEST(Sampling, NoDataRenormalisesByHand) {
  VolumeInfo info;
  info.grid = unitGrid(2, 2, 1);
  info.noData = NoDataRange{-2000, -2000};
  const auto v = volumeOf(info, std::vector<std::int16_t>{16, 32, 64, -2000});
  EXPECT_NEAR(*sampleModality(*v, PatientPoint(0.5, 0.5, 0)), (16 + 32 + 64) / 3.0, 1e-12);
  EXPECT_NEAR(*sampleModality(*v, PatientPoint(0.25, 0.25, 0)), (9 * 16 + 3 * 32 + 3 * 64) / 15.0, 1e-12);
  EXPECT_FALSE(sampleModality(*v, PatientPoint(1, 1, 0)));  // on the padding voxel itself
  EXPECT_FALSE(sampleModality(*v, PatientPoint(1, 1, 0), Interpolation::Nearest));
  EXPECT_TRUE(probeStored(*v, PatientPoint(1, 1, 0))->noData);
  const auto none = volumeOf(info, std::vector<std::int16_t>(4, -2000));
  EXPECT_FALSE(sampleModality(*none, PatientPoint(0.5, 0.5, 0)));
}

// Slices at 0, 1 and 5 (missing: 2, 3, 4): held to 1.5 and from 4.5, nothing between.
TEST(Sampling, AGapIsNoData) {
  VolumeInfo info;
  info.grid = unitGrid(1, 1, 3);
  info.grid.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1}, {0, 0, 5}};
  info.grid.gapAfter = {1};
  const auto v = volumeOf(info, std::vector<std::int16_t>{10, 20, 60});
  EXPECT_NEAR(*sampleModality(*v, PatientPoint(0, 0, 0.25)), 12.5, 1e-12);
  EXPECT_EQ(*sampleModality(*v, PatientPoint(0, 0, 1.49)), 20);
  EXPECT_FALSE(sampleModality(*v, PatientPoint(0, 0, 1.51)));
  EXPECT_FALSE(probeStored(*v, PatientPoint(0, 0, 3)));
  EXPECT_FALSE(sampleModality(*v, PatientPoint(0, 0, 4.49)));
  EXPECT_EQ(*sampleModality(*v, PatientPoint(0, 0, 4.51)), 60);
  info.grid.gapAfter.clear();  // bridged
  const auto bridged = volumeOf(info, std::vector<std::int16_t>{10, 20, 60});
  EXPECT_NEAR(*sampleModality(*bridged, PatientPoint(0, 0, 3)), 40, 1e-12);
}

}  // namespace
}  // namespace vernier
