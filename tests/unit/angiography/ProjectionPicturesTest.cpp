// SPDX-License-Identifier: GPL-3.0-or-later
// Projections through the planner against the reference in double: all modes, both cameras, cuts, tools.
#include <gtest/gtest.h>

#include "ProjectionCases.h"

namespace vernier::test {
namespace {

TEST(ProjectionPictures, ExactRaysAreTheReference) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const ProjectionMode mode : kAllModes)
      for (const int variant : {0, 1, 2, 3}) {
        LookCase c;
        c.layer().mode = mode;
        c.scene.camera.projection = projection;
        if (variant == 1) {
          c.scene.crop = CropBox{VoxelPoint(2, 3, 1.5), VoxelPoint(18, 17, 12)};
          c.scene.clip = {{PatientVec(0.6, 0.8, 0),
                           glm::dot(glm::dvec3(0.6, 0.8, 0), c.sources.volumes["v"]->grid().centre().p) + 2}};
        }
        if (variant == 2) c.layer().invert = true;
        if (variant == 3) c.scene.background = {0.1, 0.2, 0.3}, c.scene.camera.zoom = 0.7;
        const quality::ErrorReport e = c.error("projection.exact");
        EXPECT_GT(e.population, 500u);
        EXPECT_LT(e.max, 0.01) << static_cast<int>(mode) << " variant " << variant;
      }
}

TEST(ProjectionPictures, AnEyeInsideTheVolume) {
  for (const ProjectionMode mode : kAllModes) {
    LookCase c;
    c.layer().mode = mode;
    c.scene.camera.projection = Projection::Perspective;
    c.scene.camera.distance_mm = 2, c.scene.camera.fov_deg = 75;
    EXPECT_LT(c.error("projection.exact").max, 0.01) << static_cast<int>(mode);
  }
}

TEST(ProjectionPictures, ToolsStandInThePicture) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const ProjectionMode mode : kAllModes)
      for (const double opacity : {1.0, 0.5})
        for (const bool invert : {false, true}) {
          LookCase c;
          c.layer().mode = mode, c.layer().invert = invert;
          c.scene.camera.projection = projection;
          c.addTools(opacity);
          const quality::ErrorReport e = c.error("projection.exact");
          // Distances of tools are floats: a value beside the tool differs by what it changes in 1e-5 mm.
          EXPECT_LT(e.p99, 0.02) << static_cast<int>(mode) << " " << opacity << invert;
          EXPECT_LT(e.rms, 1.0) << static_cast<int>(mode) << " " << opacity << invert;
        }
}

TEST(ProjectionPictures, SampledRaysComeCloserWithTheStep) {
  for (const ProjectionMode mode : kAllModes) {
    LookCase c;
    c.layer().mode = mode;
    double before = c.error("projection.native", 1).rms;
    for (const double step : {0.5, 0.25, 0.125}) {
      const double rms = c.error("projection.native", step).rms;
      EXPECT_LT(rms, 0.6 * before + 0.01) << static_cast<int>(mode) << " step " << step;
      before = rms;
    }
    EXPECT_LT(before, 0.6) << static_cast<int>(mode);  // maxima lie on faces of cells, where the field bends
  }
}

TEST(ProjectionPictures, ADepthCueIsMeasuredToo) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
    LookCase c;
    c.layer().cue = 0.7;
    c.scene.camera.projection = projection;
    EXPECT_LT(c.error("projection.native", 1.0 / 16).p99, 0.9);
    const Result<Plan> plan = c.plan("projection.exact");
    EXPECT_FALSE(plan.ok());
  }
}

// A single bright voxel from 60 directions, the middle ray through its centre. Exact rays show all of it; a
// sample per voxel lies at most half a step beside its centre, where (1 - d_x / 2) (1 - d_y / 2) (1 - d_z /
// 2) is left of it: least along the diagonal.
TEST(ProjectionPictures, D2_ASingleBrightVoxelIsSeenFromEverywhere) {
  VolumeInfo info;
  info.grid = unitGrid(21, 21, 21);
  std::vector<std::int16_t> values(21 * 21 * 21, 0);
  values[10 + 21 * (10 + 21 * 10)] = 1000;
  LookCase c(volumeOf(info, values));
  c.view = {25, 25};
  c.layer().window = VoiWindow{500, 1000, VoiFunction::LinearExact, ""};
  double least = 1;
  for (int n = 0; n < 60; ++n) {
    c.scene.camera.azimuth_deg = 6.1 * n, c.scene.camera.elevation_deg = 3 * n - 88.0;
    c.scene.camera.projection = n % 2 ? Projection::Perspective : Projection::Orthographic;
    const std::size_t middle = 4 * (12 + 25 * 12);
    EXPECT_NEAR(c.draw("projection.exact").images.colour[middle], 1, 1e-4) << n;
    const float sampled = c.draw("projection.native").images.colour[middle];
    EXPECT_GT(sampled, 0.36f) << n;  // (1 - 0.5 / sqrt(3))^3
    least = std::min(least, static_cast<double>(sampled));
  }
  EXPECT_LT(least, 0.7);  // and the directions were not all lucky
}

TEST(ProjectionPictures, ThePlanIsOnePassAndSaysWhatItDoes) {
  LookCase c;
  c.addTools(1);
  const Result<Plan> plan = c.plan("projection.native");
  ASSERT_TRUE(plan.ok());
  ASSERT_EQ(plan->passes.size(), 1u);
  EXPECT_TRUE(plan->showsWholeScene);
  EXPECT_NE(dumpPlan(*plan).find("max, orthographic, step 0.8 mm"), std::string::npos) << dumpPlan(*plan);
  EXPECT_NE(dumpPlan(*plan).find("tools 2"), std::string::npos);
  c.layer().window = VoiWindow{0, -1, VoiFunction::Linear, ""};
  EXPECT_EQ(c.plan("projection.native").error().where, "/layers/0/window");
}

}  // namespace
}  // namespace vernier::test
