// SPDX-License-Identifier: GPL-3.0-or-later
// The reference against a second evaluation that shares nothing with it: 10,000 small steps along each of 100
// rays, in long double, on random grids with uneven slices, gaps and no-data.
#include <cmath>

#include "Scenes.h"
#include "vernier/base/Random.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;
using Real = long double;

struct Sum {
  Real value = 0, weight = 0;
};

void addSlice(const Volume& v, Real x, Real y, std::int64_t k, Real w, Sum& sum) {
  const GridGeometry& g = v.grid();
  if (!g.even()) {
    x -= g.sliceOrigin_vox[static_cast<std::size_t>(k)].x;
    y -= g.sliceOrigin_vox[static_cast<std::size_t>(k)].y;
  }
  if (x < -0.5L || y < -0.5L || x > static_cast<Real>(g.columns) - 0.5L ||
      y > static_cast<Real>(g.rows) - 0.5L)
    return;
  for (std::int64_t j = 0; j < g.rows; ++j)
    for (std::int64_t i = 0; i < g.columns; ++i) {
      // The hat function of voxel (i, j), with the border held.
      const Real cx = std::fmin(std::fmax(x, 0.0L), static_cast<Real>(g.columns - 1));
      const Real cy = std::fmin(std::fmax(y, 0.0L), static_cast<Real>(g.rows - 1));
      const Real h = std::fmax(0.0L, 1 - std::fabs(cx - static_cast<Real>(i))) *
                     std::fmax(0.0L, 1 - std::fabs(cy - static_cast<Real>(j))) * w;
      if (h <= 0 || v.isNoData(v.stored(i, j, k))) continue;
      sum.value += h * static_cast<Real>(v.modality(i, j, k));
      sum.weight += h;
    }
}

Real positionOf(const GridGeometry& g, std::int64_t k) {
  return g.even() ? static_cast<Real>(k)
                  : static_cast<Real>(g.sliceOrigin_vox[static_cast<std::size_t>(k)].z);
}

// NaN: no data.
Real bruteValue(const Volume& v, Real x, Real y, Real z) {
  const GridGeometry& g = v.grid();
  Sum sum;
  for (std::int64_t k = 0; k + 1 < g.slices; ++k) {
    const Real a = positionOf(g, k), b = positionOf(g, k + 1);
    if (z < a || z > b) continue;
    bool gap = false;
    for (std::int64_t after : g.gapAfter) gap = gap || after == k;
    if (!gap) {
      addSlice(v, x, y, k, (b - z) / (b - a), sum);
      addSlice(v, x, y, k + 1, (z - a) / (b - a), sum);
    } else if (z - a <= 0.5L) {
      addSlice(v, x, y, k, 1, sum);
    } else if (b - z <= 0.5L) {
      addSlice(v, x, y, k + 1, 1, sum);
    }
    break;
  }
  const Real first = positionOf(g, 0), last = positionOf(g, g.slices - 1);
  if (z < first && first - z <= 0.5L) addSlice(v, x, y, 0, 1, sum);
  if (z > last && z - last <= 0.5L) addSlice(v, x, y, g.slices - 1, 1, sum);
  return sum.weight > 0 ? sum.value / sum.weight : std::nanl("");
}

struct Truth {
  Real max = -1e30L, min = 1e30L, mean = 0;
  int valid = 0;
};

Truth bruteLine(const Volume& v, glm::dvec3 a_mm, glm::dvec3 b_mm) {
  const glm::dvec3 a = (v.voxelFromPatient() * PatientPoint(a_mm)).p,
                   b = (v.voxelFromPatient() * PatientPoint(b_mm)).p;
  constexpr int steps = 10000;
  Truth t;
  for (int n = 0; n < steps; ++n) {
    const Real u = (n + 0.5L) / steps;
    const Real value = bruteValue(v, a.x + u * (b.x - a.x), a.y + u * (b.y - a.y), a.z + u * (b.z - a.z));
    if (std::isnan(value)) continue;
    t.max = std::fmax(t.max, value);
    t.min = std::fmin(t.min, value);
    t.mean += value;
    ++t.valid;
  }
  if (t.valid) t.mean /= t.valid;
  return t;
}

std::shared_ptr<const Volume> randomVolume(std::uint64_t kind) {
  VolumeInfo info;
  info.grid = gridOf(4, 3, 4);
  info.grid.patientFromVoxel.linear = glm::dmat3(0.7, 0.1, 0.0, -0.2, 0.8, 0.1, 0.3, 0.1, 1.6);
  info.grid.patientFromVoxel.translation = {-30, 70, 500};
  if (kind >= 1) info.grid.sliceOrigin_vox = {{0, 0, 0}, {0.2, -0.1, 0.9}, {-0.3, 0.2, 2.2}, {0.1, 0.1, 3.1}};
  if (kind >= 2) {
    info.grid.sliceOrigin_vox.back().z = 4.0;
    info.grid.gapAfter = {2};
  }
  if (kind == 3) info.noData = NoDataRange{-20, -10};
  return floatVolume(info, [&](auto i, auto j, auto k) {
    const double r = randomUnit(77 + kind, static_cast<std::uint64_t>(i + 4 * j + 12 * k));
    return kind == 3 && r < 0.25 ? -15.0 : r;
  });
}

TEST(BruteForce, HundredRays) {
  int compared = 0;
  for (std::uint64_t ray = 0; ray < 100; ++ray) {
    const std::uint64_t kind = ray % 4;
    const auto v = randomVolume(kind);
    const auto draw = [&](std::uint64_t n) { return randomUnit(1000 + ray, n); };
    const glm::dvec3 centre_vox(3 * draw(0), 2 * draw(1), 4 * draw(2));
    const glm::dvec3 direction = glm::normalize(glm::dvec3(draw(3) - 0.5, draw(4) - 0.5, draw(5) - 0.5));
    const glm::dvec3 half = (0.3 + 3 * draw(6)) * direction;
    const glm::dvec3 c = (v->grid().patientFromVoxel * VoxelPoint(centre_vox)).p;
    const glm::dvec3 a = c - half, b = c + half;
    const Truth truth = bruteLine(*v, a, b);
    SCOPED_TRACE("ray " + std::to_string(ray) + " kind " + std::to_string(kind));
    const auto max = valueAlong(v, a, b, SlabMode::Max), min = valueAlong(v, a, b, SlabMode::Min),
               mean = valueAlong(v, a, b, SlabMode::Mean);
    // A ray that only grazes the data may differ in whether it has any.
    if (truth.valid < 5) continue;
    ASSERT_TRUE(max && min && mean);
    ++compared;
    // Steps of 1e-4 see an extremum up to the curvature within a step; at a border or next to no-data the
    // field may end with a slope.
    const double missed = 2e-3, slack = 1e-12;
    EXPECT_GE(max->value, static_cast<double>(truth.max) - slack);
    EXPECT_LE(max->value, static_cast<double>(truth.max) + missed);
    EXPECT_LE(min->value, static_cast<double>(truth.min) + slack);
    EXPECT_GE(min->value, static_cast<double>(truth.min) - missed);
    EXPECT_NEAR(mean->value, static_cast<double>(truth.mean), kind == 0 ? 1e-4 : 5e-4);
    const auto point = valueAt(v, PatientPoint(c));
    const glm::dvec3 q = (v->voxelFromPatient() * PatientPoint(c)).p;
    const Real value = bruteValue(*v, q.x, q.y, q.z);
    ASSERT_EQ(point.has_value(), !std::isnan(value));
    if (point) {
      EXPECT_NEAR(point->value, static_cast<double>(value), 1e-13);
    }
  }
  EXPECT_GT(compared, 90);
}

}  // namespace
}  // namespace vernier::quality
