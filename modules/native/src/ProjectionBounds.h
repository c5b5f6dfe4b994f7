// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds of the modality values over a volume, for rays.
//
// Fine: bricks of 4^3 cells; entry b bounds every value in cells [4b, 4b + 4). Coarse: entry b of 8^3 bounds
// every value at positions in [8b - 4, 8b + 12), so that one read at a position bounds the field up to 4
// voxels around it, whatever the direction. Parts without a valid voxel: greatest -inf, least +inf. Even
// grids only.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "vernier/native/Projection.h"

namespace vernier::native {

inline constexpr int kFineEdge = 4, kCoarseEdge = 8;
inline constexpr double kCoarseReach_vox = 4;

struct BoundsLevel {
  std::array<std::int32_t, 3> size{};
  std::vector<float> greatest, least;
  std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>(x + size[0] * (y + size[1] * z));
  }
};

class ProjectionBounds {
 public:
  BoundsLevel fine, coarse;
  std::vector<float> holes;  // of fine: 1 where a voxel is no-data; empty where there is none
  std::uint64_t bytes = 0;
};

}  // namespace vernier::native
