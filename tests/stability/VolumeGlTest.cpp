// SPDX-License-Identifier: GPL-3.0-or-later
// NUMERICS F5 to F8 on OpenGL: many thin slices, views along the slices, turns, and the eye in the volume.
#include <algorithm>
#include <cmath>

#include "../unit/dvr/GlCases.h"
#include "StackGeometry.h"

namespace vernier::test {
namespace {

constexpr const char* kSliceTechniques[] = {"dvr.stacks", "dvr.stacks2", "dvr.slabs"};

double meanDifference(const Images& a, const Images& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.colour.size(); ++n)
    sum += std::abs(static_cast<double>(a.colour[n]) - static_cast<double>(b.colour[n]));
  return 255 * sum / static_cast<double>(a.colour.size());
}

// A thousand slices of an opacity of 0.002 at the most: nothing of them is lost to the target's format.
TEST(RenderingStability, F5_AThousandThinSlicesLoseNothing) {
  VERNIER_NEEDS_GL(device);
  GridGeometry grid = unitGrid(6, 1024, 6);
  grid.patientFromVoxel.linear = glm::dmat3(0.5);
  VolumeInfo info;
  info.grid = grid;
  DvrCase c(volumeOf(info, randomValues<std::int16_t>(6 * 1024 * 6, 3, 0, 100)));
  c.scene.camera = {};  // along the rows: all slices on each ray
  c.scene.camera.height_mm = 3, c.view = {16, 16};
  c.layer().transfer =
      TransferFunction{{{0, {1, 0.5, 0.1}}, {100, {0.2, 0.6, 1}}}, {{0, 0}, {100, 0.002}}, 0.5};
  const DvrTruth truth(c);
  ASSERT_EQ(dvr::stackAxis(c.camera(), grid), 1);
  for (const char* technique : kSliceTechniques) {
    const Result<Images> images = c.draw(technique);
    ASSERT_TRUE(images.ok()) << images.error().text();
    const bool stack = std::string(technique) != "dvr.slabs";
    const Off off = offFrom(*images, [&](double x, double y) {
      return stack ? truth.stack(x, y, 1, 1) : truth.rays(x, y, true);
    });
    EXPECT_LT(off.worst, 0.01) << technique;
  }
}

// NUMERICS: view-aligned slices have no gaps, and the stacks' switch at 45 degrees is not seen.
TEST(RenderingStability, F6_ViewsAlongTheSlicesAndTheSwitchOfStacks) {
  VERNIER_NEEDS_GL(device);
  DvrCase c(bumpyVolume(unitGrid(26, 26, 26), {}, 0));
  c.quality.step = 0.5;
  for (const Projection projection : kBothProjections) {
    c.scene.camera = {};
    c.scene.camera.projection = projection;
    const DvrTruth truth(c);  // exactly along columns and slices
    const Result<Images> along = c.draw("dvr.slabs");
    ASSERT_TRUE(along.ok());
    EXPECT_LT(offFrom(*along, [&](double x, double y) { return truth.rays(x, y, true); }).worst, 0.1);
    for (const bool elevation : {false, true}) {
      Camera before, behind;
      before.projection = behind.projection = projection;
      (elevation ? before.elevation_deg : before.azimuth_deg) = 44.999;
      (elevation ? behind.elevation_deg : behind.azimuth_deg) = 45.001;
      c.scene.camera = before;
      const int axis = dvr::stackAxis(c.camera(), c.volume().grid());
      const Result<Images> one = c.draw("dvr.stacks");
      c.scene.camera = behind;
      EXPECT_NE(dvr::stackAxis(c.camera(), c.volume().grid()), axis);
      const Result<Images> other = c.draw("dvr.stacks");
      const Off off = offFrom(*other, colourOf(*one), 3);
      EXPECT_EQ(off.wrong, 0u) << off.worst;
    }
  }
}

// The popping detector: from degree to degree no picture jumps by more than 3 times the median.
TEST(RenderingStability, F7_ATurnByDegreesDoesNotPop) {
  VERNIER_NEEDS_GL(device);
  for (const char* technique : {"dvr.rays", "dvr.stacks", "dvr.slabs"}) {
    DvrCase c(bumpyVolume(unitGrid(24, 24, 24), {}, 0));
    c.scene.camera = {};
    c.view = {40, 40}, c.quality.step = 0.5;
    std::vector<double> jumps;
    Result<Images> before = c.draw(technique);
    ASSERT_TRUE(before.ok()) << before.error().text();
    for (int degree = 1; degree <= 90; ++degree) {
      c.scene.camera.azimuth_deg = degree;
      Result<Images> now = c.draw(technique);
      ASSERT_TRUE(now.ok());
      jumps.push_back(meanDifference(*now, *before));
      before = std::move(now);
    }
    std::vector<double> sorted = jumps;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_GT(sorted[45], 0.01);
    EXPECT_LT(sorted.back(), 3 * sorted[45]) << technique;
  }
}

// Rays begin at the near distance, and no wedge is missing.
TEST(RenderingStability, F8_TheEyeInTheVolumeAt130Degrees) {
  VERNIER_NEEDS_GL(device);
  for (const double near_mm : {0.0, 2.5}) {
    DvrCase c;
    c.scene.camera.projection = Projection::Perspective, c.scene.camera.fov_deg = 130;
    c.scene.camera.distance_mm = 2, c.scene.camera.near_mm = near_mm, c.scene.camera.zoom = 1;
    c.layer().transfer->opacityLength_mm = 10;
    // Something on every ray, so that a wedge would be seen.
    c.layer().transfer->opacities = {{-100, 0.3}, {300, 0.9}};
    const DvrTruth truth(c);
    const int axis = dvr::stackAxis(c.camera(), c.volume().grid());
    for (const char* technique :
         {"dvr.rays", "dvr.stacks", "dvr.stacks2", "dvr.stacks4", "dvr.slabs", "dvr.strips"}) {
      const Result<Images> images = c.draw(technique);
      ASSERT_TRUE(images.ok()) << images.error().text();
      const std::string name = technique;
      const Off off = offFrom(*images, [&](double x, double y) {
        return name.find("stacks") != std::string::npos ? truth.stack(x, y, axis, 1)
                                                        : truth.rays(x, y, name != "dvr.rays");
      });
      EXPECT_LE(off.wrong, off.pixels / 1000) << technique << " worst " << off.worst;
      const Off empty = offFrom(
          *images, [&](double, double) { return DvrTruth::rgb(c.scene.background); }, 5);
      EXPECT_EQ(empty.wrong, empty.pixels) << technique;
    }
  }
}

}  // namespace
}  // namespace vernier::test
