// SPDX-License-Identifier: GPL-3.0-or-later
#include "ProjectionBounds.h"

#include <algorithm>
#include <limits>

#include "vernier/base/Threads.h"
#include "vernier/volume/Bricks.h"

namespace vernier::native {
namespace {

std::array<std::int32_t, 3> blocks(const GridGeometry& g, int edge) {
  const auto count = [edge](std::int64_t n) { return static_cast<std::int32_t>((n + edge - 1) / edge); };
  return {count(g.columns), count(g.rows), count(g.slices)};
}

std::size_t entries(const std::array<std::int32_t, 3>& n) {
  return static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(n[2]);
}

BoundsLevel coarseOf(const BoundsLevel& fine, const GridGeometry& grid) {
  BoundsLevel out;
  out.size = blocks(grid, kCoarseEdge);
  out.greatest.resize(entries(out.size)), out.least.resize(entries(out.size));
  // Positions [8b - 4, 8b + 12) touch the fine entries 2b - 1 .. 2b + 2.
  const auto reach = [&](std::int64_t b, int axis) {
    return std::pair{std::max<std::int64_t>(2 * b - 1, 0),
                     std::min<std::int64_t>(2 * b + 2, fine.size[static_cast<std::size_t>(axis)] - 1)};
  };
  parallelFor(static_cast<std::size_t>(out.size[2]), 1, [&](std::size_t begin, std::size_t end) {
    for (auto z = static_cast<std::int64_t>(begin); z < static_cast<std::int64_t>(end); ++z)
      for (std::int64_t y = 0; y < out.size[1]; ++y)
        for (std::int64_t x = 0; x < out.size[0]; ++x) {
          float high = -std::numeric_limits<float>::infinity(), low = -high;
          const auto [x0, x1] = reach(x, 0);
          const auto [y0, y1] = reach(y, 1);
          const auto [z0, z1] = reach(z, 2);
          for (std::int64_t k = z0; k <= z1; ++k)
            for (std::int64_t j = y0; j <= y1; ++j)
              for (std::int64_t i = x0; i <= x1; ++i) {
                high = std::max(high, fine.greatest[fine.index(i, j, k)]);
                low = std::min(low, fine.least[fine.index(i, j, k)]);
              }
          out.greatest[out.index(x, y, z)] = high, out.least[out.index(x, y, z)] = low;
        }
  });
  return out;
}

}  // namespace

std::uint64_t bytesOfBounds(const GridGeometry& grid) {
  return 2 * sizeof(float) * (entries(blocks(grid, kFineEdge)) + entries(blocks(grid, kCoarseEdge)));
}

Result<std::shared_ptr<const ProjectionBounds>> projectionBounds(const Volume& volume) {
  if (volume.isColour() || !volume.grid().even())
    return makeError(ErrorCode::Internal, "Bounds are made of grey volumes with even slices.",
                     "projectionBounds");
  auto out = std::make_shared<ProjectionBounds>();
  Bricks bricks = makeBricks(volume, kFineEdge);
  out->fine.size = blocks(volume.grid(), kFineEdge);
  out->fine.greatest = std::move(bricks.max), out->fine.least = std::move(bricks.min);
  if (std::any_of(bricks.hasNoData.begin(), bricks.hasNoData.end(), [](std::uint8_t h) { return h != 0; }))
    out->holes.assign(bricks.hasNoData.begin(), bricks.hasNoData.end());
  out->coarse = coarseOf(out->fine, volume.grid());
  out->bytes = bytesOfBounds(volume.grid()) + sizeof(float) * out->holes.size();
  return std::shared_ptr<const ProjectionBounds>(std::move(out));
}

}  // namespace vernier::native
