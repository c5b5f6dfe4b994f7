// SPDX-License-Identifier: GPL-3.0-or-later
#include "Range.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "Exclusion.h"
#include "VoxelAccess.h"
#include "vernier/base/Threads.h"

namespace vernier {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 18;  // voxels per piece of work

template <class T>
struct Extrema {
  T min = std::numeric_limits<T>::max();
  T max = std::numeric_limits<T>::lowest();
};

// kLanes running extrema side by side, so that the compiler may use SIMD without reordering anything. NaN
// never compares, so it never enters.
constexpr std::size_t kLanes = 32;

template <class T, class Excluded>
Extrema<T> extremaWithout(const T* v, std::size_t n, Excluded excluded) {
  constexpr T kNeutralMin = std::numeric_limits<T>::max(), kNeutralMax = std::numeric_limits<T>::lowest();
  T min[kLanes], max[kLanes];
  std::fill_n(min, kLanes, kNeutralMin);
  std::fill_n(max, kLanes, kNeutralMax);
  const auto take = [&](std::size_t lane, T x) {
    const bool out = excluded(x);
    const T low = out ? kNeutralMin : x;
    const T high = out ? kNeutralMax : x;
    min[lane] = low < min[lane] ? low : min[lane];
    max[lane] = high > max[lane] ? high : max[lane];
  };
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) take(lane, v[i + lane]);
  for (; i < n; ++i) take(0, v[i]);
  return {*std::min_element(min, min + kLanes), *std::max_element(max, max + kLanes)};
}

// One slice. An empty result has min > max. A slice may hold nothing but the neutral elements themselves (all
// 65535, say): min = 65535, max = 65535 then, since both ends see each valid voxel.
template <class T>
Extrema<T> sliceExtrema(const T* v, std::size_t n, const std::optional<NoDataRange>& noData) {
  return withExclusion<T>(noData, [&](auto excluded) { return extremaWithout(v, n, excluded); });
}

}  // namespace

NonFinite cleanFloats(VoxelType type, std::byte* voxels, std::size_t count) {
  NonFinite found;
  if (type != VoxelType::F32) return found;
  std::atomic<std::uint64_t> nan{0}, plus{0}, minus{0};
  float* const v = reinterpret_cast<float*>(voxels);
  parallelFor(count, kGrain, [&](std::size_t begin, std::size_t end) {
    constexpr std::uint32_t kExponent = 0x7f800000u;  // all ones: infinite or NaN
    std::uint32_t any = 0;
    for (std::size_t i = begin; i < end; ++i)
      any |= (std::bit_cast<std::uint32_t>(v[i]) & kExponent) == kExponent ? 1u : 0u;
    if (!any) return;
    for (std::size_t i = begin; i < end; ++i) {
      if (std::isnan(v[i])) ++nan;
      if (!std::isinf(v[i])) continue;
      ++(v[i] > 0 ? plus : minus);
      v[i] = std::numeric_limits<float>::quiet_NaN();
    }
  });
  found.nan = nan;
  found.plusInf = plus;
  found.minusInf = minus;
  return found;
}

std::optional<Volume::Range> modalityExtrema(VoxelType type, const std::byte* voxels, std::size_t perSlice,
                                             std::size_t slices, const std::vector<ModalityRescale>& rescale,
                                             const std::optional<NoDataRange>& noData) {
  std::vector<std::optional<Volume::Range>> perSliceRange(slices);
  parallelFor(slices, std::max<std::size_t>(1, kGrain / std::max<std::size_t>(1, perSlice)),
              [&](std::size_t begin, std::size_t end) {
                for (std::size_t s = begin; s < end; ++s)
                  withVoxels(type, voxels, [&](const auto* v) {
                    const auto e = sliceExtrema(v + s * perSlice, perSlice, noData);
                    if (e.min > e.max) return;
                    const ModalityRescale& r = rescale[rescale.size() == 1 ? 0 : s];
                    const double a = r.slope * static_cast<double>(e.min) + r.intercept;
                    const double b = r.slope * static_cast<double>(e.max) + r.intercept;
                    perSliceRange[s] = Volume::Range{std::min(a, b), std::max(a, b)};
                  });
              });
  std::optional<Volume::Range> all;
  for (const auto& r : perSliceRange) {
    if (!r) continue;
    if (!all) all = r;
    all->min = std::min(all->min, r->min);
    all->max = std::max(all->max, r->max);
  }
  return all;
}

}  // namespace vernier
