// SPDX-License-Identifier: GPL-3.0-or-later
// Min-max bricks: for each brick of edge^3 cells bounds of the modality values of all voxels that
// interpolation inside the brick can touch (the brick's voxels plus one layer on the high side), no-data left
// out. Made on request; cache them by the volume's revision.
//
// Brick (bx, by, bz) covers Voxel-frame i in [bx edge, (bx+1) edge), j likewise, and *slice index* in [bz
// edge, (bz+1) edge); positions below 0 belong to brick 0, positions in the last half voxel to the last
// brick. Slices that wander in the plane (sliceOrigin_vox.xy) widen what a brick can touch. min and max are
// rounded outwards to float, so they are true bounds. A brick without a valid voxel has min > max. hasNoData
// is 1 where a voxel is no-data or a gap lies inside the brick. Runs on all cores.
#pragma once
#include <cstdint>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/volume/Volume.h"

namespace vernier {

struct Bricks {
  int edge = 8;
  std::int64_t nx = 0, ny = 0, nz = 0;
  std::vector<float> min, max;  // modality values
  std::vector<std::uint8_t> hasNoData;
  std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>(x + nx * (y + ny * z));
  }
};
VERNIER_API Bricks makeBricks(const Volume&, int edge = 8);  // edge >= 1

}  // namespace vernier
