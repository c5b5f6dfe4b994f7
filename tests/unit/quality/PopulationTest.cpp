// SPDX-License-Identifier: GPL-3.0-or-later
#include "Population.h"

#include <algorithm>

#include "Scenes.h"
#include "vernier/base/Random.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

std::vector<char> maskOf(const SliceScene& s) {
  const auto layers = Layers::make(s.scene, s.view, s.sources, {});
  EXPECT_TRUE(layers.ok());
  std::vector<char> mask(static_cast<std::size_t>(s.view.width_px * s.view.height_px), 0);
  for (std::size_t p : population(*layers, s.view)) {
    EXPECT_EQ(mask[p], 0) << "listed twice";
    mask[p] = 1;
  }
  return mask;
}

TEST(Population, IsTheOutlineDilatedByTwoPixels) {
  const auto v = floatVolume(gridOf(20, 10, 3), [](auto, auto, auto) { return 1.0; });
  const SliceScene s =
      sliceScene(v, Plane{v->grid().centre(), PatientVec(0, 0, -1), PatientVec(0, -1, 0)}, 40, 40);
  const auto mask = maskOf(s);
  EXPECT_EQ(std::count(mask.begin(), mask.end(), 1), 24 * 14);
  EXPECT_TRUE(mask[13 * 40 + 8]);
  EXPECT_FALSE(mask[12 * 40 + 8]);
  EXPECT_FALSE(mask[13 * 40 + 7]);
}

TEST(Population, IsEmptyBesideTheVolume) {
  const auto v = floatVolume(gridOf(4, 4, 4), [](auto, auto, auto) { return 1.0; });
  const SliceScene s =
      sliceScene(v, Plane{PatientPoint(0, 0, 5), PatientVec(0, 0, 1), PatientVec(0, 1, 0)}, 16, 16);
  const auto mask = maskOf(s);
  EXPECT_EQ(std::count(mask.begin(), mask.end(), 1), 0);
}

TEST(Population, HoldsEveryPixelThatHasDataAndFewOthers) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto draw = [&](std::uint64_t n) { return randomUnit(seed, n) - 0.5; };
    GridGeometry g = gridOf(7, 5, 6);
    g.patientFromVoxel.linear = glm::dmat3(1, 0.2, 0.1, -0.1, 1.2, 0, 0.3, 0.2, seed % 2 ? 2.0 : -2.0);
    if (seed % 4 == 3)
      g.sliceOrigin_vox = {{0, 0, 0}, {0.5, 0, 1}, {1, 0, 2.4}, {0, -0.5, 3}, {0, 0, 4}, {0, 0, 5}};
    const auto v = floatVolume(g, [](auto, auto, auto) { return 1.0; });
    SliceScene s =
        sliceScene(v,
                   Plane{PatientPoint(g.centre().p + glm::dvec3(draw(0), draw(1), 4 * draw(2))),
                         PatientVec(draw(3), draw(4), draw(5)), PatientVec(draw(6), draw(7), draw(8))},
                   48, 20);
    if (seed % 3) s.layer().slab = Slab{6 * (draw(9) + 0.5), SlabMode::Max};
    const auto mask = maskOf(s);
    const auto layers = Layers::make(s.scene, s.view, s.sources, {});
    std::size_t covered = 0, listed = 0;
    for (std::size_t p = 0; p < mask.size(); ++p) {
      const bool data = layers->covers(centreOf(p, s.view));
      EXPECT_TRUE(!data || mask[p]) << "seed " << seed << " pixel " << p;
      covered += data;
      listed += static_cast<std::size_t>(mask[p]);
    }
    EXPECT_GT(covered, 0u);
    // At most a rim of some pixels: the outline of a picture of 48 x 48.
    EXPECT_LT(listed, covered + 900) << seed;
  }
}

}  // namespace
}  // namespace vernier::quality
