// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bricks.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "vernier/base/Threads.h"

namespace vernier::quality {
namespace {

using Extent = BrickRanges::Extent;

// In the Voxel frame. Slices that wander carry their voxels along, and hold their border for half a voxel.
std::array<glm::dvec3, 8> cornersOf(const GridGeometry& g, Extent x, Extent y, Extent z) {
  glm::dvec3 low(static_cast<double>(x.first), static_cast<double>(y.first), static_cast<double>(z.first));
  glm::dvec3 high(static_cast<double>(x.last), static_cast<double>(y.last), static_cast<double>(z.last));
  if (!g.even()) {
    glm::dvec2 least(0), most(0);
    for (std::int64_t k = z.first; k <= z.last; ++k) {
      const glm::dvec2 o(g.sliceOrigin_vox[static_cast<std::size_t>(k)]);
      least = glm::min(least, o), most = glm::max(most, o);
    }
    low = {glm::dvec2(low) + least - 0.5, g.sliceOrigin_vox[static_cast<std::size_t>(z.first)].z};
    high = {glm::dvec2(high) + most + 0.5, g.sliceOrigin_vox[static_cast<std::size_t>(z.last)].z};
  }
  std::array<glm::dvec3, 8> out;
  for (std::size_t n = 0; n < 8; ++n)
    out[n] = {n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z};
  return out;
}

// Whether all corners lie beyond one face.
bool outside(const ConvexRegion& region, const GridGeometry& g, const std::array<glm::dvec3, 8>& corners) {
  return std::any_of(region.planes.begin(), region.planes.end(), [&](const HalfSpace& h) {
    return std::all_of(corners.begin(), corners.end(), [&](glm::dvec3 c) {
      return h.distance_mm(g.patientFromVoxel * VoxelPoint(c)) > 1e-9;
    });
  });
}

}  // namespace

BrickOutlines brickOutlines(const VolumeRays& rays, const std::function<bool(const LocalRange&)>& contributes,
                            const ConvexRegion* within) {
  const GridGeometry& g = rays.volume().grid();
  const auto known = rays.bricks() ? rays.bricks() : std::make_shared<const BrickRanges>(rays.fieldVolume());
  const std::vector<BrickRanges::Brick>& bricks = known->bricks();
  BrickOutlines all;
  std::mutex merging;
  parallelFor(bricks.size(), 64, [&](std::size_t begin, std::size_t end) {
    BrickOutlines mine;
    for (std::size_t n = begin; n < end; ++n) {
      const BrickRanges::Brick& b = bricks[n];
      const std::array<glm::dvec3, 8> corners = cornersOf(g, b.x, b.y, b.z);
      if (!contributes(b.values) || rays.keepsNoneOf(corners)) continue;
      if (within && outside(*within, g, corners)) continue;
      std::array<glm::dvec2, 8> px;
      bool before = true;
      for (std::size_t c = 0; c < 8; ++c)
        before = rays.camera().pixelOf((g.patientFromVoxel * VoxelPoint(corners[c])).p, px[c]) && before;
      before ? mine.corners_px.push_back(px) : void(mine.everywhere = true);
    }
    const std::lock_guard lock(merging);
    all.corners_px.insert(all.corners_px.end(), mine.corners_px.begin(), mine.corners_px.end());
    all.everywhere = all.everywhere || mine.everywhere;
  });
  return all;
}

}  // namespace vernier::quality
