// SPDX-License-Identifier: GPL-3.0-or-later
#include "LossyPadding.h"

#include <limits>
#include <vector>

#include "VoxelAccess.h"

namespace vernier {
namespace {

template <class T>
std::uint64_t fill(T* v, std::int64_t columns, std::int64_t rows, const NoDataRange& padding,
                   double threshold, T paddingValue) {
  const auto isPadding = [&](T x) {
    const double d = static_cast<double>(x);
    return d >= padding.first && d <= padding.last;
  };
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(columns * rows), 0);
  std::vector<std::int64_t> open;
  std::uint64_t changed = 0;
  const auto visit = [&](std::int64_t i, std::int64_t j) {
    if (i < 0 || j < 0 || i >= columns || j >= rows) return;
    const std::int64_t at = i + columns * j;
    if (seen[static_cast<std::size_t>(at)]) return;
    seen[static_cast<std::size_t>(at)] = 1;
    const bool padded = isPadding(v[at]);
    if (!padded && !(static_cast<double>(v[at]) < threshold)) return;
    if (!padded) {
      v[at] = paddingValue;
      ++changed;
    }
    open.push_back(at);
  };
  for (std::int64_t i = 0; i < columns; ++i) visit(i, 0), visit(i, rows - 1);
  for (std::int64_t j = 0; j < rows; ++j) visit(0, j), visit(columns - 1, j);
  while (!open.empty()) {
    const std::int64_t i = open.back() % columns, j = open.back() / columns;
    open.pop_back();
    visit(i - 1, j), visit(i + 1, j), visit(i, j - 1), visit(i, j + 1);
  }
  return changed;
}

}  // namespace

NoDataRange blurredPaddingOf(VoxelType type) {
  const double lowest = withVoxels(type, nullptr, [](const auto* v) {
    return static_cast<double>(std::numeric_limits<std::remove_cvref_t<decltype(*v)>>::lowest());
  });
  return {lowest, lowest};
}

std::uint64_t markBlurredPadding(VoxelType type, std::byte* slice, std::int64_t columns, std::int64_t rows,
                                 const NoDataRange& padding, double threshold, double paddingValue) {
  return withVoxels(type, slice, [&](const auto* v) {
    using T = std::remove_cvref_t<decltype(*v)>;
    return fill(const_cast<T*>(v), columns, rows, padding, threshold, static_cast<T>(paddingValue));
  });
}

}  // namespace vernier
