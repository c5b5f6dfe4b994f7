// SPDX-License-Identifier: GPL-3.0-or-later
#include "BrickRanges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "vernier/base/Threads.h"

namespace vernier::quality {
namespace {

constexpr std::int64_t kLeastEdge = 8, kMostPerAxis = 32;  // cells; bricks

// Least and greatest of each row's stored values first: a slope and an intercept keep their order, or turn
// it.
template <class T>
LocalRange rangeOf(const Volume& v, const BrickRanges::Brick& b) {
  const GridGeometry& g = v.grid();
  const auto* const voxels = reinterpret_cast<const T*>(v.data());
  constexpr double inf = std::numeric_limits<double>::infinity();
  const bool some = v.info().noData.has_value();
  const double first = some ? v.info().noData->first : inf, last = some ? v.info().noData->last : -inf;
  LocalRange r;
  for (std::int64_t k = b.z.first; k <= b.z.last; ++k) {
    const ModalityRescale& rescale = v.rescaleOf(k);
    for (std::int64_t j = b.y.first; j <= b.y.last; ++j) {
      const T* const row = voxels + (k * g.rows + j) * g.columns;
      LocalRange stored;
      for (std::int64_t i = b.x.first; i <= b.x.last; ++i) {
        const auto s = static_cast<double>(row[i]);  // NaN is neither below nor above anything
        if (!(s >= first && s <= last)) stored.add(s);
      }
      if (stored.min > stored.max) continue;
      r.add(rescale.slope * stored.min + rescale.intercept);
      r.add(rescale.slope * stored.max + rescale.intercept);
    }
  }
  return r;
}

LocalRange rangeOf(const Volume& v, const BrickRanges::Brick& b) {
  switch (v.type()) {
    case VoxelType::U8:
      return rangeOf<std::uint8_t>(v, b);
    case VoxelType::I8:
      return rangeOf<std::int8_t>(v, b);
    case VoxelType::U16:
      return rangeOf<std::uint16_t>(v, b);
    case VoxelType::I16:
      return rangeOf<std::int16_t>(v, b);
    case VoxelType::U32:
      return rangeOf<std::uint32_t>(v, b);
    case VoxelType::I32:
      return rangeOf<std::int32_t>(v, b);
    default:
      return rangeOf<float>(v, b);
  }
}

}  // namespace

BrickRanges::BrickRanges(const Volume& v) {
  const GridGeometry& g = v.grid();
  inPlace_ = g.even();
  const glm::i64vec3 cells(g.columns - 1, g.rows - 1, g.slices - 1);
  for (int axis = 0; axis < 3; ++axis) {
    edge_[axis] = std::max(kLeastEdge, (cells[axis] + kMostPerAxis - 1) / kMostPerAxis);
    count_[axis] = (cells[axis] + edge_[axis] - 1) / edge_[axis];
  }
  bricks_.resize(static_cast<std::size_t>(count_.x * count_.y * count_.z));
  parallelFor(bricks_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const auto at = static_cast<std::int64_t>(n);
      const glm::i64vec3 place(at % count_.x, at / count_.x % count_.y, at / count_.x / count_.y);
      const auto extent = [&](int axis) {
        const std::int64_t first = place[axis] * edge_[axis];
        return Extent{first, std::min(first + edge_[axis], cells[axis])};
      };
      Brick& b = bricks_[n];
      b.x = extent(0), b.y = extent(1), b.z = extent(2);
      b.values = rangeOf(v, b);
    }
  });
}

std::vector<BrickRanges::Passage> BrickRanges::passages(glm::dvec3 from, glm::dvec3 across) const {
  std::vector<double> t{0};
  for (int axis = 0; axis < 3; ++axis) {
    if (across[axis] == 0) continue;
    for (std::int64_t n = 1; n < count_[axis]; ++n) {
      const double at = (static_cast<double>(n * edge_[axis]) - from[axis]) / across[axis];
      if (at > 0 && at < 1) t.push_back(at);
    }
  }
  t.push_back(1);
  std::sort(t.begin(), t.end());
  std::vector<Passage> out;
  for (std::size_t n = 0; n + 1 < t.size(); ++n) {
    if (!(t[n + 1] > t[n])) continue;
    const glm::dvec3 mid = from + 0.5 * (t[n] + t[n + 1]) * across;
    glm::i64vec3 place;
    for (int axis = 0; axis < 3; ++axis)
      place[axis] = std::clamp<std::int64_t>(
          static_cast<std::int64_t>(std::floor(mid[axis] / static_cast<double>(edge_[axis]))), 0,
          count_[axis] - 1);
    out.push_back(
        {static_cast<std::size_t>(place.x + count_.x * (place.y + count_.y * place.z)), t[n], t[n + 1]});
  }
  return out;
}

}  // namespace vernier::quality
