// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures with lenses drawn by the engine: every pair of the algebra on four voxels, by hand.
#include "LensHost.h"

namespace vernier::lens {
namespace {

using namespace vernier::test;

TEST(LensPairs, AllByHand) {
  const LensHost host;
  std::size_t drawn = 0;
  for (const algebra::Case& c : algebra::pairs()) {
    SCOPED_TRACE(c.name);
    const Result<Plan> p = host.plan(c.scene, c.view, c.sources);
    ASSERT_TRUE(p.ok()) << p.error().text();
    const Result<Images> images = host.draw(*p);
    ASSERT_TRUE(images.ok()) << images.error().text();
    ++drawn;
    for (const algebra::Case::Pixel& at : c.pixels)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(static_cast<double>(images->colour[4 * at.index + static_cast<std::size_t>(k)]),
                    at.ofLevels[k], 2e-3)
            << "pixel " << at.index << " channel " << k;
  }
  EXPECT_EQ(drawn, 10u * 11 * 4);
}

}  // namespace
}  // namespace vernier::lens
