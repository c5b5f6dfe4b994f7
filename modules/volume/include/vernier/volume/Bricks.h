// SPDX-License-Identifier: GPL-3.0-or-later
// Min-max bricks: for each brick of edge^3 cells the least and greatest stored value of all voxels that
// interpolation inside the brick can touch (the brick's voxels plus one layer on the high side). Made on
// request; cache them by the volume's revision. noData counts voxels that are excluded; an all-no-data brick
// has min > max.
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
VERNIER_API Bricks makeBricks(const Volume&, int edge = 8);

}  // namespace vernier
