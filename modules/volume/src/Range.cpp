// SPDX-License-Identifier: GPL-3.0-or-later
#include "Range.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <type_traits>

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

// The loops below are written so that the compiler turns them into SIMD minima and maxima.
template <class T>
Extrema<T> extremaOf(const T* v, std::size_t n) {
  Extrema<T> e;
  for (std::size_t i = 0; i < n; ++i) {
    e.min = v[i] < e.min ? v[i] : e.min;
    e.max = v[i] > e.max ? v[i] : e.max;
  }
  return e;
}

// Without [first, last]. What is left out counts as the neutral element of each.
template <class T>
Extrema<T> extremaWithout(const T* v, std::size_t n, T first, T last) {
  Extrema<T> e;
  for (std::size_t i = 0; i < n; ++i) {
    const bool out = v[i] >= first && v[i] <= last;
    const T low = out ? std::numeric_limits<T>::max() : v[i];
    const T high = out ? std::numeric_limits<T>::lowest() : v[i];
    e.min = low < e.min ? low : e.min;
    e.max = high > e.max ? high : e.max;
  }
  return e;
}

// The values of T inside a no-data range given in double; nullopt when T holds none of them.
template <class T>
std::optional<std::pair<T, T>> rangeIn(const NoDataRange& range) {
  if constexpr (std::is_floating_point_v<T>) {
    T first = static_cast<T>(range.first), last = static_cast<T>(range.last);
    if (first < range.first) first = std::nextafter(first, std::numeric_limits<T>::infinity());
    if (last > range.last) last = std::nextafter(last, -std::numeric_limits<T>::infinity());
    return first <= last ? std::optional(std::pair(first, last)) : std::nullopt;
  } else {
    const double first =
        std::max(std::ceil(range.first), static_cast<double>(std::numeric_limits<T>::lowest()));
    const double last = std::min(std::floor(range.last), static_cast<double>(std::numeric_limits<T>::max()));
    if (first > last) return std::nullopt;
    return std::pair(static_cast<T>(first), static_cast<T>(last));
  }
}

// One slice. An empty result has min > max. A slice may hold nothing but the neutral elements themselves (all
// 65535, say): min = 65535, max = 65535 then, since both ends see each valid voxel.
template <class T>
Extrema<T> sliceExtrema(const T* v, std::size_t n, const std::optional<NoDataRange>& noData) {
  if (noData)
    if (const auto out = rangeIn<T>(*noData)) return extremaWithout(v, n, out->first, out->second);
  return extremaOf(v, n);
}

}  // namespace

NonFinite cleanFloats(VoxelType type, std::byte* voxels, std::size_t count) {
  NonFinite found;
  if (type != VoxelType::F32) return found;
  std::atomic<std::uint64_t> nan{0}, plus{0}, minus{0};
  float* const v = reinterpret_cast<float*>(voxels);
  parallelFor(count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t any = 0;  // x - x is 0 for finite x only
    for (std::size_t i = begin; i < end; ++i) any |= v[i] - v[i] != 0.0f;
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
