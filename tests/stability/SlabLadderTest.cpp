// SPDX-License-Identifier: GPL-3.0-or-later
// Slabs on the quality ladder, with real pictures: a smaller step never makes a slab worse, and the closed
// loop ends at its goal or says what it reached.
#include <algorithm>
#include <cmath>

#include "../unit/volume/Grids.h"
#include "RenderForTest.h"
#include "vernier/quality/Badge.h"
#include "vernier/quality/Ladder.h"

namespace vernier {
namespace {

using namespace vernier::test;

struct SlabCase {
  Scene scene;
  View view{32, 32, true};
  Sources sources;
};

// Smooth structures a few voxels wide, cut obliquely by 7 mm.
SlabCase slabCase(SlabMode mode) {
  GridGeometry g = unitGrid(40, 40, 30);
  g.patientFromVoxel.linear = glm::dmat3(0.8, 0, 0, 0, 0.8, 0, 0, 0, 1.5);
  std::vector<std::int16_t> values;
  for (int k = 0; k < 30; ++k)
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i)
        values.push_back(
            static_cast<std::int16_t>(500 * std::sin(1.3 * i) * std::cos(1.1 * j) * std::sin(0.9 * k)));
  VolumeInfo info;
  info.grid = g;
  SlabCase c;
  SliceLayer layer;
  layer.source = "v";
  layer.plane = Plane{g.centre(), PatientVec(0.4, -0.3, 0.8), PatientVec(0, 1, 0)};
  layer.slab = Slab{7, mode};
  layer.window = VoiWindow{0, 1000, VoiFunction::LinearExact, ""};
  c.scene.layers.emplace_back(layer);
  c.scene.camera.height_mm = 26;  // within the volume: no rim
  c.sources.volumes["v"] = volumeOf<std::int16_t>(std::move(info), values);
  return c;
}

Result<quality::ErrorReport> measured(const SlabCase& c, const Frame& frame) {
  quality::ErrorOptions options;
  options.samples = 32 * 32;  // every pixel
  return quality::measureError(frame, c.scene, c.view, c.sources, options);
}

TEST(SlabLadder, ASmallerStepIsNeverWorse) {
  for (SlabMode mode : {SlabMode::Max, SlabMode::Min, SlabMode::Mean}) {
    const SlabCase c = slabCase(mode);
    for (const std::string& technique : sliceTechniques()) {
      SCOPED_TRACE(technique);
      double last = 1e9, first = 0;
      for (double step : {1.0, 0.5, 0.25}) {
        const auto r = renderWith(technique, c.scene, c.view, c.sources, step);
        if (!r && technique != "mpr.native" && r.error().code == ErrorCode::NoTechnique) break;
        ASSERT_TRUE(r.ok()) << r.error().text();
        const auto e = measured(c, r->frame);
        ASSERT_TRUE(e.ok());
        ASSERT_TRUE(e->exhaustive);
        EXPECT_LE(e->rms, 1.02 * last + 0.01) << step;
        last = e->rms;
        if (step == 1.0) first = e->rms;
      }
      EXPECT_LT(last, 0.5 * first);
    }
  }
}

TEST(SlabLadder, TheClosedLoopReachesItsGoalOrSaysSo) {
  const SlabCase c = slabCase(SlabMode::Mean);
  int drawn = 0;
  const auto climb = [&](double goal) {
    drawn = 0;
    return quality::climb(
        [&](double step) -> Result<Frame> {
          ++drawn;
          auto r = renderWith("mpr.native", c.scene, c.view, c.sources, step);
          if (!r) return r.error();
          return std::move(r->frame);
        },
        [&](const Frame& frame, double) { return measured(c, frame); }, {.goal = goal});
  };
  // Goals as parts of what the first rung has.
  const auto first = climb(255);
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(drawn, 1);
  const double bound = *first->reached.error.bound;
  ASSERT_GT(bound, 0.1);
  const auto review = climb(0.5 * bound), reference = climb(0.05 * bound);
  ASSERT_TRUE(review.ok() && reference.ok());
  EXPECT_TRUE(review->goalReached) << review->said;
  EXPECT_TRUE(reference->goalReached) << reference->said;
  EXPECT_LE(*reference->reached.error.bound, 0.05 * bound);
  EXPECT_LT(reference->reached.step, review->reached.step);
  EXPECT_LE(reference->reached.error.rms, review->reached.error.rms);
  const auto impossible = climb(1e-12);
  ASSERT_TRUE(impossible.ok());
  EXPECT_FALSE(impossible->goalReached);
  EXPECT_EQ(drawn, 6);  // 1, 1/2 .. 1/32
  EXPECT_EQ(impossible->said.substr(0, 18), "goal not reached: ");
}

}  // namespace
}  // namespace vernier
