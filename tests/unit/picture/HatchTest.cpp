// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Hatch.h"

#include <gtest/gtest.h>

namespace vernier {
namespace {

// 16 x 16 columns and rows of 1 mm; slices at z = 0, 1, 6, 7 mm. A coronal picture of 32 x 32 pixels, 0.5 mm
// each, whose top left corner is at x = -0.5, z = 15: most of its upper half is above the stack.
struct GapScene {
  GridGeometry grid;
  SlicePicture slice;
  Images images;
  Picture picture{32, 32};
  GapScene() {
    grid.columns = grid.rows = 16;
    grid.slices = 4;
    grid.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1}, {0, 0, 6}, {0, 0, 7}};
    grid.gapAfter = {1};
    slice.origin = PatientPoint(-0.5, 8, 15);
    slice.right = PatientVec(0.5, 0, 0);
    slice.down = PatientVec(0, 0, -0.5);
    images.allocate(32, 32, false);
    for (int y = 0; y < 32; ++y) {
      const double z = z_mm(y);
      const bool data = (z >= -0.5 && z < 1.5) || (z >= 5.5 && z < 7.5);
      for (int x = 0; x < 32; ++x)
        images.depth[static_cast<std::size_t>(32 * y + x)] = data ? 0.0f : kNothing_mm;
    }
  }
  static double z_mm(int y) { return 15 - 0.5 * (y + 0.5); }
};

TEST(Hatch, CoversTheGapAndNothingElse) {
  GapScene s;
  EXPECT_EQ(hatchGaps(s.picture, s.images, s.slice, s.grid), 32u * 8u) << "4 mm of 0.5 mm rows";
  for (int y = 0; y < 32; ++y) {
    const double z = GapScene::z_mm(y);
    int drawn = 0;
    for (int x = 0; x < 32; ++x) drawn += s.picture.at(x, y)[0] > 0;
    EXPECT_EQ(drawn, z > 1.5 && z < 5.5 ? 8 : 0) << "z " << z;
  }
}

TEST(Hatch, BridgedGapsHaveDataAndAreLeftAlone) {
  GapScene s;
  std::fill(s.images.depth.begin(), s.images.depth.end(), 0.0f);
  EXPECT_EQ(hatchGaps(s.picture, s.images, s.slice, s.grid), 0u);
  EXPECT_EQ(s.picture, Picture(32, 32));
}

TEST(Hatch, OutsideTheImagesIsNoGap) {
  GapScene s;
  s.slice.origin = PatientPoint(7.5, 8, 15);  // columns from 7.5 mm on: the last pixels lie beyond column 15
  EXPECT_EQ(hatchGaps(s.picture, s.images, s.slice, s.grid), 16u * 8u);
  s.slice.origin = PatientPoint(-0.5, 17, 15);
  EXPECT_EQ(hatchGaps(s.picture, s.images, s.slice, s.grid), 0u);
}

TEST(Hatch, EvenStacksHaveNone) {
  GapScene s;
  s.grid.sliceOrigin_vox.clear();
  s.grid.gapAfter.clear();
  EXPECT_EQ(hatchGaps(s.picture, s.images, s.slice, s.grid), 0u);
}

}  // namespace
}  // namespace vernier
