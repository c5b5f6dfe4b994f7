// SPDX-License-Identifier: GPL-3.0-or-later
// Reads one sample in double, with every rule of GridGeometry.h: uneven slices, gaps, no-data, per-slice
// rescale. The fast kernel hands it the few samples that it cannot do itself.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "vernier/volume/Cubic.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Volume.h"

namespace vernier::native {

// Positions are rounded to this part of a voxel by both kernels, so that a plane through voxel centres gives
// the stored values bit by bit although its mm positions were rounded; it is also the tolerance at the outer
// faces.
inline constexpr double kPositionUnit = 1.0 / (1 << 24);
inline double roundedPosition(double p_vox) {
  return std::abs(p_vox) < 1e8 ? std::nearbyint(p_vox / kPositionUnit) * kPositionUnit : p_vox;
}

template <class T>
class GeneralSampler {
 public:
  explicit GeneralSampler(const Volume& v)
      : volume_(v),
        grid_(v.grid()),
        data_(reinterpret_cast<const T*>(v.data())),
        hasRange_(v.info().noData.has_value()),
        first_(hasRange_ ? v.info().noData->first : 0),
        last_(hasRange_ ? v.info().noData->last : 0) {}

  // Modality value at a voxel position, NaN = no data. Counts 1 into `samples` when the position lies in the
  // volume.
  double linear(const glm::dvec3& p, std::uint64_t& samples) const {
    return mapped(Interpolation::Linear, p, samples, [](double voxel) { return voxel; });
  }

  // Linear where one of the voxels that cubic needs has no data.
  double cubic(const glm::dvec3& p, std::uint64_t& samples) const {
    Pair z;
    if (!slicesAt(p.z, z)) return kNone;
    const Four slices = fourSlices(z);
    double value = 0;
    for (std::size_t n = 0; n < 4; ++n)
      if (slices.weight[n] != 0)
        value += slices.weight[n] * cubicInSlice(p, slices.first + static_cast<std::int64_t>(n));
    if (std::isnan(value)) return linear(p, samples);
    ++samples;
    return value;
  }

  double nearest(const glm::dvec3& p, std::uint64_t& samples) const {
    Pair x, y, z;
    if (!slicesAt(p.z, z)) return kNone;
    const std::int64_t k = z.t >= 0.5 ? z.second : z.first;
    if (!inPlane(p, k, x, y)) return kNone;
    ++samples;
    return modality(x.t >= 0.5 ? x.second : x.first, y.t >= 0.5 ? y.second : y.first, k);
  }

  // Nearest or linear of a function of each voxel's modality value.
  template <class OfVoxel>
  double mapped(Interpolation how, const glm::dvec3& p, std::uint64_t& samples, OfVoxel&& ofVoxel) const {
    if (how == Interpolation::Nearest) {
      const double voxel = nearest(p, samples);
      return std::isnan(voxel) ? voxel : ofVoxel(voxel);
    }
    Pair z;
    if (!slicesAt(p.z, z)) return kNone;
    Sum sum;
    bool inside = addSlice(sum, p, z.first, 1.0 - z.t, ofVoxel);
    if (z.t > 0) inside |= addSlice(sum, p, z.second, z.t, ofVoxel);
    samples += inside ? 1 : 0;
    return sum.weight >= kLeastWeight ? sum.value / sum.weight : kNone;
  }

  double value(Interpolation how, const glm::dvec3& p, std::uint64_t& samples) const {
    return how == Interpolation::Linear  ? linear(p, samples)
           : how == Interpolation::Cubic ? cubic(p, samples)
                                         : nearest(p, samples);
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  // Less valid weight than this comes from the rounding of the position only.
  static constexpr double kLeastWeight = 1e-6;
  struct Pair {
    std::int64_t first = 0, second = 0;
    double t = 0;
  };
  struct Sum {
    double weight = 0, value = 0;
  };

  // Indices first .. first + 3; those without weight may lie outside.
  struct Four {
    std::int64_t first = 0;
    std::array<double, 4> weight{};
  };

  static Four fourAlong(const Pair& at, std::int64_t n) {
    const double before = at.first > 0 ? 1 : 0, after = at.first + 2 < n ? 1 : 0;
    return {at.first - 1, cubicWeights(at.t, before, after)};
  }

  Four fourSlices(const Pair& z) const {
    if (z.first == z.second) return {z.first - 1, {0, 1, 0, 0}};
    if (grid_.even()) return fourAlong(z, grid_.slices);
    const auto height = [&](std::int64_t slice) {
      return grid_.sliceOrigin_vox[static_cast<std::size_t>(slice)].z;
    };
    const double step = height(z.second) - height(z.first);
    // The distance between two neighbouring slices in steps; 0 where they are none to each other.
    const auto distance = [&](std::int64_t lower) {
      if (lower < 0 || lower + 1 >= grid_.slices ||
          std::binary_search(grid_.gapAfter.begin(), grid_.gapAfter.end(), lower))
        return 0.0;
      const double d = (height(lower + 1) - height(lower)) / step;
      return d >= kNearestNeighbour && d <= kFurthestNeighbour ? d : 0.0;
    };
    return {z.first - 1, cubicWeights(z.t, distance(z.first - 1), distance(z.second))};
  }

  // NaN where a voxel that counts has no data, or the slice does not reach there.
  double cubicInSlice(const glm::dvec3& p, std::int64_t k) const {
    Pair x, y;
    if (!inPlane(p, k, x, y)) return kNone;
    const Four columns = fourAlong(x, grid_.columns), rows = fourAlong(y, grid_.rows);
    double value = 0;
    for (std::int64_t j = 0; j < 4; ++j) {
      const double w = rows.weight[static_cast<std::size_t>(j)];
      if (w == 0) continue;
      double row = 0;
      for (std::int64_t i = 0; i < 4; ++i)
        if (const double v = columns.weight[static_cast<std::size_t>(i)]; v != 0)
          row += v * modality(columns.first + i, rows.first + j, k);
      value += w * row;
    }
    return value;
  }

  static bool along(double x, std::int64_t n, Pair& out) {
    const double last = static_cast<double>(n - 1);
    x = roundedPosition(x);
    if (!(x >= -0.5 && x <= last + 0.5)) return false;
    x = std::clamp(x, 0.0, last);
    const double whole = std::floor(x);
    out.first = static_cast<std::int64_t>(whole);
    out.second = std::min(out.first + 1, n - 1);
    out.t = x - whole;
    return true;
  }

  // The slices on both sides of z; only one of them (t = 0) where a gap or an end is held.
  bool slicesAt(double z, Pair& out) const {
    if (grid_.even()) return along(z, grid_.slices, out);
    const auto& o = grid_.sliceOrigin_vox;
    const double half = 0.5 + kPositionUnit;
    if (!(z >= o.front().z - half && z <= o.back().z + half)) return false;
    const auto next = std::upper_bound(
        o.begin(), o.end(), z, [](double value, const glm::dvec3& origin) { return value < origin.z; });
    const std::int64_t s = std::max<std::int64_t>(next - o.begin() - 1, 0);
    out = {s, s, 0};
    if (next == o.begin() || next == o.end()) return true;
    const double below = z - o[static_cast<std::size_t>(s)].z;
    const double above = next->z - z;
    if (std::binary_search(grid_.gapAfter.begin(), grid_.gapAfter.end(), s)) {
      if (std::min(below, above) > half) return false;
      if (above <= below) out = {s + 1, s + 1, 0};
      return true;
    }
    const double t = below / (below + above);
    if (t > 1 - kPositionUnit / 2)
      out = {s + 1, s + 1, 0};
    else if (t >= kPositionUnit / 2)
      out = {s, s + 1, t};
    return true;
  }

  bool inPlane(const glm::dvec3& p, std::int64_t slice, Pair& x, Pair& y) const {
    const glm::dvec3 o =
        grid_.even() ? glm::dvec3(0) : grid_.sliceOrigin_vox[static_cast<std::size_t>(slice)];
    return along(p.x - o.x, grid_.columns, x) && along(p.y - o.y, grid_.rows, y);
  }

  template <class OfVoxel>
  bool addSlice(Sum& sum, const glm::dvec3& p, std::int64_t k, double weight, OfVoxel&& ofVoxel) const {
    Pair x, y;
    if (!inPlane(p, k, x, y)) return false;
    const auto add = [&](std::int64_t i, std::int64_t j, double w) {
      if (!(w > 0)) return;
      const double value = modality(i, j, k);
      if (std::isnan(value)) return;
      sum.weight += w;
      sum.value += w * ofVoxel(value);
    };
    add(x.first, y.first, weight * (1 - x.t) * (1 - y.t));
    add(x.second, y.first, weight * x.t * (1 - y.t));
    add(x.first, y.second, weight * (1 - x.t) * y.t);
    add(x.second, y.second, weight * x.t * y.t);
    return true;
  }

  double modality(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const double stored = static_cast<double>(data_[i + grid_.columns * (j + grid_.rows * k)]);
    if (std::isnan(stored) || (hasRange_ && stored >= first_ && stored <= last_)) return kNone;
    const ModalityRescale& r = volume_.rescaleOf(k);
    return r.slope * stored + r.intercept;
  }

  const Volume& volume_;
  const GridGeometry& grid_;
  const T* data_;
  bool hasRange_;
  double first_, last_;
};

}  // namespace vernier::native
