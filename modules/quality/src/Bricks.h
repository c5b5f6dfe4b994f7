// SPDX-License-Identifier: GPL-3.0-or-later
// Where in the picture the parts of a volume that can show something lie: bricks of the reference's own, each
// with the range of its voxels.
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "VolumeRays.h"

namespace vernier::quality {

struct BrickOutlines {
  std::vector<std::array<glm::dvec2, 8>> corners_px;  // of the bricks that can show something
  bool everywhere = false;                            // one of them reaches past the eye
};
// `contributes`: whether voxels of such a range (least above greatest: none with data) can show something.
// `within`, when given: only those that do not lie outside of it for sure.
BrickOutlines brickOutlines(const VolumeRays&, const std::function<bool(const LocalRange&)>& contributes,
                            const ConvexRegion* within = nullptr);

}  // namespace vernier::quality
