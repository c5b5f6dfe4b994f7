// SPDX-License-Identifier: GPL-3.0-or-later
#include "Percentile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <mutex>
#include <numeric>

#include "Exclusion.h"
#include "VoxelAccess.h"
#include "vernier/base/Threads.h"

namespace vernier {
namespace {

// Keys: unsigned 32-bit numbers in the order of the values.
std::uint32_t keyOf(float x) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}
float floatOf(std::uint32_t key) {
  return std::bit_cast<float>(key & 0x80000000u ? key & 0x7fffffffu : ~key);
}
template <class T>
std::uint32_t keyOfStored(T x) {
  if constexpr (std::is_floating_point_v<T>) {
    return keyOf(x);
  } else {
    const std::int64_t fromLowest = static_cast<std::int64_t>(x) - std::numeric_limits<T>::lowest();
    return static_cast<std::uint32_t>(fromLowest) << (32 - 8 * sizeof(T));
  }
}
template <class T>
double storedOfKey(std::uint32_t key) {
  if constexpr (std::is_floating_point_v<T>) {
    return floatOf(key);
  } else {
    return static_cast<double>(key >> (32 - 8 * sizeof(T))) +
           static_cast<double>(std::numeric_limits<T>::lowest());
  }
}

using Histogram = std::vector<std::uint64_t>;
constexpr std::size_t kBins = 65536;

// Histogram of bin(key) over all valid voxels; bin returns kBins for keys that don't count.
template <class T, class Key, class Bin>
Histogram histogramOf(const std::vector<SliceValues>& slices, const std::optional<NoDataRange>& excluded,
                      Key key, Bin bin) {
  Histogram all(kBins, 0);
  std::mutex mutex;
  const std::size_t pieces = std::max<std::size_t>(1, 2 * static_cast<std::size_t>(threads()));
  parallelFor(slices.size(), (slices.size() + pieces - 1) / pieces, [&](std::size_t begin, std::size_t end) {
    Histogram mine(kBins + 1, 0);
    withExclusion<T>(excluded, [&](auto out) {
      for (std::size_t s = begin; s < end; ++s) {
        const T* const v = reinterpret_cast<const T*>(slices[s].data);
        for (std::size_t i = 0; i < slices[s].count; ++i)
          ++mine[out(v[i]) || notANumber(v[i]) ? kBins : bin(key(v[i], slices[s].rescale))];
      }
    });
    const std::lock_guard lock(mutex);
    for (std::size_t i = 0; i < kBins; ++i) all[i] += mine[i];
  });
  return all;
}

// The bin that holds the value of rank `rank` (from 1); rank becomes the rank within the bin.
std::size_t binOfRank(const Histogram& h, std::uint64_t& rank) {
  std::size_t bin = 0;
  while (rank > h[bin]) rank -= h[bin++];
  return bin;
}

// Keys of the values of rank ceil(n / 100) and ceil(99 n / 100); counted from the other end when `falling`.
// fine: the low 16 bits of the keys are in use.
template <class T, class Key>
std::optional<std::array<std::uint32_t, 2>> keysOfRanks(const std::vector<SliceValues>& slices,
                                                        const std::optional<NoDataRange>& excluded, Key key,
                                                        bool fine, bool falling) {
  const Histogram high =
      histogramOf<T>(slices, excluded, key, [](std::uint32_t k) { return std::size_t{k >> 16}; });
  const std::uint64_t n = std::accumulate(high.begin(), high.end(), std::uint64_t{0});
  if (n == 0) return std::nullopt;
  std::array<std::uint32_t, 2> keys{};
  for (std::size_t r = 0; r < 2; ++r) {
    std::uint64_t rank = r == 0 ? (n + 99) / 100 : n - n / 100;
    if (falling) rank = n + 1 - rank;
    const std::size_t top = binOfRank(high, rank);
    std::size_t low = 0;
    if (fine) {
      const auto inTop = [top](std::uint32_t k) {
        return (k >> 16) == top ? std::size_t{k & 0xffffu} : kBins;
      };
      low = binOfRank(histogramOf<T>(slices, excluded, key, inTop), rank);
    }
    keys[r] = static_cast<std::uint32_t>(top << 16 | low);
  }
  return keys;
}

bool sameRescale(const std::vector<SliceValues>& slices) {
  return std::all_of(slices.begin(), slices.end(),
                     [&](const SliceValues& s) { return s.rescale == slices.front().rescale; });
}

template <class T>
std::optional<Volume::Range> percentilesOf(const std::vector<SliceValues>& slices,
                                           const std::optional<NoDataRange>& excluded) {
  if (!sameRescale(slices)) {
    const auto key = [](T x, const ModalityRescale& r) {
      return keyOf(static_cast<float>(r.slope * static_cast<double>(x) + r.intercept));
    };
    const auto keys = keysOfRanks<T>(slices, excluded, key, true, false);
    if (!keys) return std::nullopt;
    return Volume::Range{floatOf((*keys)[0]), floatOf((*keys)[1])};
  }
  const ModalityRescale r = slices.front().rescale;
  const auto key = [](T x, const ModalityRescale&) { return keyOfStored(x); };
  const auto keys = keysOfRanks<T>(slices, excluded, key, sizeof(T) == 4, r.slope < 0);
  if (!keys) return std::nullopt;
  return Volume::Range{r.slope * storedOfKey<T>((*keys)[0]) + r.intercept,
                       r.slope * storedOfKey<T>((*keys)[1]) + r.intercept};
}

}  // namespace

std::optional<Volume::Range> percentiles1And99(VoxelType type, const std::vector<SliceValues>& slices,
                                               const std::optional<NoDataRange>& excluded) {
  if (slices.empty()) return std::nullopt;
  return withVoxels(type, slices.front().data, [&](const auto* v) {
    return percentilesOf<std::remove_cvref_t<decltype(*v)>>(slices, excluded);
  });
}

double leastWidth(VoxelType type, const ModalityRescale& r) {
  return type == VoxelType::F32 ? 1 : std::abs(r.slope);
}

VoiWindow windowOver(const std::optional<Volume::Range>& range, double leastWidth_val) {
  VoiWindow w{0.5, 1, VoiFunction::LinearExact, "automatic"};
  if (!range) return w;
  w.center = range->min + (range->max - range->min) / 2;
  // Never so narrow that centre +- width / 2 round to one number.
  w.width = std::max({range->max - range->min, leastWidth_val, std::abs(w.center) * 1e-12});
  return w;
}

}  // namespace vernier
