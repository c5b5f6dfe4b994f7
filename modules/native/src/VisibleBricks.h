// SPDX-License-Identifier: GPL-3.0-or-later
// Boxes of fine bricks (ProjectionBounds.h) in which something may be seen: bricks that are full of visible
// ones are joined to boxes of 2, 4, 8 bricks, so that the inside of a body costs little.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "vernier/native/VolumeRender.h"

namespace vernier::native {

struct BrickBox {
  std::uint16_t x = 0, y = 0, z = 0, edge = 1;  // in bricks; may reach beyond the last one
};

class VisibleBricks {
 public:
  const std::uint64_t id = nextId();  // of no other
  std::vector<BrickBox> boxes;
  std::vector<BrickBox> holes;  // bricks in which, or next to which, a voxel is no-data, seen or not
  std::array<std::int32_t, 3> size{};

 private:
  static std::uint64_t nextId() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
  }
};

}  // namespace vernier::native
