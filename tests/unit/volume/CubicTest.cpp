// SPDX-License-Identifier: GPL-3.0-or-later
// Cubic interpolation against what theory says of it: exact for quadratics, passes through the samples, Keys'
// weights, the stated overshoot; and its rules at borders, gaps, uneven slices and no-data.
#include "vernier/volume/Cubic.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "Grids.h"
#include "vernier/volume/Sampling.h"

namespace vernier {
namespace {

using test::everyGrid;
using test::unitGrid;
using test::volumeOf;

// Keys' kernel with a = -1/2, from the paper.
double keys(double x) {
  x = std::abs(x);
  if (x < 1) return 1.5 * x * x * x - 2.5 * x * x + 1;
  return x < 2 ? -0.5 * x * x * x + 2.5 * x * x - 4 * x + 2 : 0;
}

TEST(CubicWeights, AreKeysKernelOnEvenSamples) {
  for (double t = 0; t <= 1; t += 1.0 / 64) {
    const auto w = cubicWeights(t, 1, 1);
    for (int n = 0; n < 4; ++n) EXPECT_NEAR(w[static_cast<std::size_t>(n)], keys(t - (n - 1)), 1e-15) << t;
  }
}

TEST(CubicWeights, PassThroughTheSamplesExactly) {
  for (const double before : {0.0, 0.6, 1.0, 1.7})
    for (const double after : {0.0, 0.6, 1.0, 1.7}) {
      EXPECT_EQ(cubicWeights(0, before, after), (std::array<double, 4>{0, 1, 0, 0}));
      const auto end = cubicWeights(1, before, after);
      EXPECT_EQ(end[0], 0);
      EXPECT_NEAR(end[1], 0, 1e-15);
      EXPECT_NEAR(end[2], 1, 1e-15);
      EXPECT_EQ(end[3], 0);
    }
}

TEST(CubicWeights, ReproduceQuadraticsWhateverTheDistances) {
  for (const double before : {0.0, 0.5, 1.0, 1.9})
    for (const double after : {0.0, 0.5, 1.0, 1.9})
      for (double t = 0; t <= 1; t += 0.0625) {
        const auto w = cubicWeights(t, before, after);
        const double x[4] = {-before, 0, 1, 1 + after};
        const int most = before > 0 || after > 0 ? 2 : 1;
        for (int power = 0; power <= most; ++power) {
          double sum = 0;
          for (std::size_t n = 0; n < 4; ++n) sum += w[n] * std::pow(x[n], power);
          EXPECT_NEAR(sum, std::pow(t, power), 1e-14) << before << " " << after << " " << t << " " << power;
        }
      }
}

TEST(CubicWeights, OvershootAsStated) {
  double widest = 0, undershoot = 0;
  for (double t = 0; t <= 1; t += 1.0 / 3000) {
    double sum = 0;
    for (double w : cubicWeights(t, 1, 1)) sum += std::abs(w);
    widest = std::max(widest, sum);
    undershoot =
        std::min(undershoot, cubicWeights(t, 1, 1)[0]);  // three samples on top of an edge, one below
  }
  EXPECT_NEAR(widest, 1.25,
              1e-12);  // so 1/8 of the range beyond it, and (1.25^3 - 1) / 2 in three dimensions
  EXPECT_NEAR(-undershoot, 2.0 / 27, 1e-9);
}

double quadratic(const glm::dvec3& fromCentre_mm) {
  const glm::dvec3 q = fromCentre_mm / 10.0;
  return 20 + 3 * q.x - 5 * q.y + 2 * q.z + 4 * q.x * q.x - 3 * q.y * q.y + 2.5 * q.z * q.z +
         1.5 * q.x * q.y - 2 * q.y * q.z + q.x * q.z;
}

glm::dvec3 centreOf(const GridGeometry& g, std::int64_t i, std::int64_t j, std::int64_t k) {
  const glm::dvec3 o = g.even() ? glm::dvec3(0, 0, k) : g.sliceOrigin_vox[static_cast<std::size_t>(k)];
  return (g.patientFromVoxel * VoxelPoint(static_cast<double>(i) + o.x, static_cast<double>(j) + o.y, o.z)).p;
}

template <class Fn>
std::shared_ptr<const Volume> filled(const GridGeometry& g, const Fn& fn) {
  VolumeInfo info;
  info.grid = g;
  std::vector<float> values;
  for (std::int64_t k = 0; k < g.slices; ++k)
    for (std::int64_t j = 0; j < g.rows; ++j)
      for (std::int64_t i = 0; i < g.columns; ++i) values.push_back(static_cast<float>(fn(i, j, k)));
  return volumeOf<float>(info, values);
}

std::vector<test::NamedGrid> gridsForQuadratics() {
  std::vector<test::NamedGrid> grids;
  for (const auto& g : everyGrid())
    if (g.grid.even()) grids.push_back(g);
  GridGeometry uneven = grids[1].grid;
  for (int s = 0; s < 9; ++s)
    uneven.sliceOrigin_vox.push_back({0.03 * std::sin(s), -0.02 * s, s + 0.1 * std::cos(2.0 * s)});
  grids.push_back({"uneven", uneven});
  GridGeometry three = grids[1].grid;
  three.columns = three.rows = three.slices = 3;
  grids.push_back({"three voxels along each axis", three});
  return grids;
}

// To the last cell: the parabola at the border is Keys' boundary condition.
TEST(CubicSampling, IsExactForQuadraticsBetweenAllVoxelCentres) {
  for (const auto& named : gridsForQuadratics()) {
    const GridGeometry& g = named.grid;
    const auto v =
        filled(g, [&](auto i, auto j, auto k) { return quadratic(centreOf(g, i, j, k) - g.centre().p); });
    double worst = 0, worstLinear = 0;
    for (std::uint64_t n = 0; n < 400; ++n) {
      const double last = static_cast<double>(g.columns - 1);
      const auto at = [&](std::uint64_t axis, double count) {
        const double r = randomUnit(5, 3 * n + axis);
        return g.even() ? r * count : (0.2 + 0.6 * r) * count;  // slices that wander: stay inside all of them
      };
      const double first = g.firstPosition_vox(), height = g.lastPosition_vox() - first;
      const PatientPoint p =
          g.patientFromVoxel *
          VoxelPoint(at(0, last), at(1, static_cast<double>(g.rows - 1)), first + at(2, height));
      const auto cubic = sampleModality(*v, p, Interpolation::Cubic), linear = sampleModality(*v, p);
      ASSERT_TRUE(cubic && linear) << named.name;
      worst = std::max(worst, std::abs(*cubic - quadratic(p.p - g.centre().p)));
      worstLinear = std::max(worstLinear, std::abs(*linear - quadratic(p.p - g.centre().p)));
    }
    EXPECT_LT(worst, 1e-4) << named.name;        // the voxels are floats
    EXPECT_GT(worstLinear, 1e-3) << named.name;  // which linear interpolation is not
  }
}

TEST(CubicSampling, GivesTheStoredValueAtEveryVoxelCentre) {
  for (const auto& named : everyGrid()) {
    const GridGeometry& g = named.grid;
    const auto v = filled(
        g, [](auto i, auto j, auto k) { return static_cast<double>((i * 37 + j * 101 + k * 53) % 97); });
    for (std::int64_t k = 0; k < g.slices; ++k)
      for (std::int64_t j = 0; j < g.rows; ++j)
        for (std::int64_t i = 0; i < g.columns; ++i) {
          const auto got = sampleModality(*v, PatientPoint(centreOf(g, i, j, k)), Interpolation::Cubic);
          ASSERT_TRUE(got) << named.name;
          EXPECT_NEAR(*got, static_cast<double>((i * 37 + j * 101 + k * 53) % 97), 1e-8) << named.name;
        }
  }
}

// Slices beyond a gap, or much nearer or further than the step, have no say.
TEST(CubicSampling, NeverLooksAcrossAGapOrAtASliceOutOfStep) {
  GridGeometry g = unitGrid(5, 5, 6);
  for (const double z : {0.0, 1.0, 2.0, 5.0, 6.0, 7.0}) g.sliceOrigin_vox.push_back({0, 0, z});
  g.gapAfter = {2};
  GridGeometry close = unitGrid(5, 5, 6);
  for (const double z : {0.0, 1.0, 2.0, 2.4, 3.4, 4.4}) close.sliceOrigin_vox.push_back({0, 0, z});
  for (const GridGeometry& grid : {g, close}) {
    const auto with = [&](double beyond) {
      return filled(grid, [&](auto, auto, auto k) { return k > 2 ? beyond : static_cast<double>(k * k); });
    };
    const PatientPoint p(2.3, 1.7, 1.5);
    const double a = *sampleModality(*with(50), p, Interpolation::Cubic);
    EXPECT_EQ(a, *sampleModality(*with(-999), p, Interpolation::Cubic));
    EXPECT_NEAR(a, 1.5 * 1.5, 1e-12);  // the parabola through the three slices below
  }
  GridGeometry even = unitGrid(5, 5, 6);
  const auto v = filled(even, [&](auto, auto, auto k) { return k > 2 ? 50.0 : static_cast<double>(k * k); });
  EXPECT_NE(*sampleModality(*v, PatientPoint(2.3, 1.7, 1.5), Interpolation::Cubic), 1.5 * 1.5);
}

TEST(CubicSampling, IsLinearWhereOneOfItsVoxelsHasNoData) {
  GridGeometry g = unitGrid(8, 8, 8);
  VolumeInfo info;
  info.grid = g;
  info.noData = NoDataRange{-5, -5};
  std::vector<std::int16_t> values = test::randomValues<std::int16_t>(512, 3, 0, 100);
  values[2 + 8 * (3 + 8 * 3)] = -5;
  const auto v = volumeOf<std::int16_t>(info, values);
  int linear = 0, cubic = 0;
  for (std::uint64_t n = 0; n < 4000; ++n) {
    const glm::dvec3 p(randomUnit(9, 3 * n) * 7, randomUnit(9, 3 * n + 1) * 7, randomUnit(9, 3 * n + 2) * 7);
    // Taps of cell i are i - 1 .. i + 2.
    const glm::ivec3 cell(glm::floor(p));
    bool takes = true;
    const int hole[3] = {2, 3, 3};
    for (int a = 0; a < 3; ++a) takes = takes && hole[a] >= cell[a] - 1 && hole[a] <= cell[a] + 2;
    const double got = *sampleModality(*v, PatientPoint(p), Interpolation::Cubic);
    const double plain = *sampleModality(*v, PatientPoint(p));
    if (takes) {
      EXPECT_EQ(got, plain);
      ++linear;
    } else {
      cubic += got != plain;
    }
  }
  EXPECT_GT(linear, 100);
  EXPECT_GT(cubic, 1000);
  // A tap without weight does not count: on the plane of slice 4 the hole in slice 3 is none of its business.
  const PatientPoint onSlice(2.5, 3.5, 4);
  EXPECT_NE(*sampleModality(*v, onSlice, Interpolation::Cubic), *sampleModality(*v, onSlice));
}

}  // namespace
}  // namespace vernier
