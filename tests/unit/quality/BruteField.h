// SPDX-License-Identifier: GPL-3.0-or-later
// The field a second time, in long double, from the hat functions of all voxels; and random volumes for it.
#pragma once
#include <cmath>

#include "Scenes.h"
#include "vernier/base/Random.h"

namespace vernier::test {

using Real = long double;

struct Sum {
  Real value = 0, weight = 0;
};

inline void addSlice(const Volume& v, Real x, Real y, std::int64_t k, Real w, Sum& sum) {
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

inline Real positionOf(const GridGeometry& g, std::int64_t k) {
  return g.even() ? static_cast<Real>(k)
                  : static_cast<Real>(g.sliceOrigin_vox[static_cast<std::size_t>(k)].z);
}

// NaN: no data.
inline Real bruteValue(const Volume& v, Real x, Real y, Real z) {
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

// Random grids: even and oblique, uneven, with a gap, with no-data too, left-handed.
inline std::shared_ptr<const Volume> randomVolume(std::uint64_t kind) {
  VolumeInfo info;
  info.grid = gridOf(4, 3, 4);
  info.grid.patientFromVoxel.linear = glm::dmat3(0.7, 0.1, 0.0, -0.2, 0.8, 0.1, 0.3, 0.1, 1.6);
  info.grid.patientFromVoxel.translation = {-30, 70, 500};
  if (kind == 4) info.grid.patientFromVoxel.linear[2] *= -1;
  if (kind >= 1 && kind <= 3)
    info.grid.sliceOrigin_vox = {{0, 0, 0}, {0.2, -0.1, 0.9}, {-0.3, 0.2, 2.2}, {0.1, 0.1, 3.1}};
  if (kind == 2 || kind == 3) {
    info.grid.sliceOrigin_vox.back().z = 4.0;
    info.grid.gapAfter = {2};
  }
  if (kind == 3) info.noData = NoDataRange{-20, -10};
  return floatVolume(info, [&](auto i, auto j, auto k) {
    const double r = randomUnit(77 + kind, static_cast<std::uint64_t>(i + 4 * j + 12 * k));
    return kind == 3 && r < 0.25 ? -15.0 : r;
  });
}

}  // namespace vernier::test
