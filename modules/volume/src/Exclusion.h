// SPDX-License-Identifier: GPL-3.0-or-later
// The test for no-data in the voxels' own type, in a form that SIMD loops can take: withExclusion<T>(range,
// fn) calls fn with a predicate bool(T) that is true for voxels in the range. NaN is left to the loops: it
// never compares.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "vernier/volume/Volume.h"

namespace vernier {

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

template <class T>
bool notANumber([[maybe_unused]] T x) {
  if constexpr (std::is_floating_point_v<T>) {
    return x != x;
  } else {
    return false;
  }
}

template <class T, class Fn>
auto withExclusion(const std::optional<NoDataRange>& noData, Fn&& fn) {
  const auto range = noData ? rangeIn<T>(*noData) : std::nullopt;
  if (!range) return fn([](T) { return false; });
  const T first = range->first, last = range->second;
  if constexpr (std::is_floating_point_v<T>) {
    return fn([first, last](T x) { return (x >= first) & (x <= last); });
  } else {
    using U = std::make_unsigned_t<T>;  // first <= x <= last in one comparison
    const U width = static_cast<U>(static_cast<U>(last) - static_cast<U>(first));
    return fn(
        [first, width](T x) { return static_cast<U>(static_cast<U>(x) - static_cast<U>(first)) <= width; });
  }
}

}  // namespace vernier
