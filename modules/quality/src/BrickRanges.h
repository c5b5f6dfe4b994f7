// SPDX-License-Identifier: GPL-3.0-or-later
// The reference's own bricks of a volume: the range of the voxels of each, and which of them a line passes.
#pragma once
#include <vector>

#include "Field.h"

namespace vernier::quality {

class BrickRanges {
 public:
  // Reads all voxels, on all cores.
  explicit BrickRanges(const Volume&);

  // Cells from `first` to `last`, the voxels at both ends included.
  struct Extent {
    std::int64_t first = 0, last = 0;
  };
  struct Brick {
    Extent x, y, z;
    LocalRange values;  // least above greatest: none with data
  };
  const std::vector<Brick>& bricks() const { return bricks_; }

  // Whether voxels lie where their indices say, so that bricks are boxes in the Voxel frame.
  bool inPlace() const { return inPlace_; }
  // The bricks that from + t across passes, t in [0, 1], in order. It lies within the box of voxel centres.
  struct Passage {
    std::size_t brick = 0;
    double begin = 0, end = 0;
  };
  std::vector<Passage> passages(glm::dvec3 from_vox, glm::dvec3 across_vox) const;

 private:
  glm::i64vec3 count_{0}, edge_{1};
  bool inPlace_ = true;
  std::vector<Brick> bricks_;
};

}  // namespace vernier::quality
