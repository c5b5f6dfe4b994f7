// SPDX-License-Identifier: GPL-3.0-or-later
// Volume rendering with tools, its extremes, and colour volumes: pixels that can be told by hand.
#include <gtest/gtest.h>

#include "VolumeCases.h"

namespace vernier {
namespace {

using test::VolumeCase;
using test::volumeCase;

constexpr double kDepth = 0.05;  // extinction of the medium, per mm

TransferFunction medium() { return {{{0, {.8, .5, .2}}}, {{0, 1 - std::exp(-kDepth)}}, 1}; }

std::shared_ptr<const Volume> block(std::int16_t value = 100) {
  VolumeInfo info;
  info.grid = test::unitGrid(21, 21, 21);
  return test::volumeOf(info, std::vector<std::int16_t>(21 * 21 * 21, value));
}

// Seen from the front, so that a ray passes 20 mm.
struct Block {
  Scene scene;
  VolumeCase c;
  double face = 0;
  native::SurfaceHits tools;
  explicit Block(std::shared_ptr<const Volume> volume = block(), const TransferFunction& f = medium()) {
    scene.background = {.1, .2, .3};
    Camera camera;
    camera.height_mm = 1;
    c = volumeCase(std::move(volume), f, camera, {2, 1}, scene);
    face = spanOf(c.job.camera.ray(0.5, 0.5), c.job.region, 0).entry_mm;
    // Pixel 0: a translucent sheet before, one within. Pixel 1: an opaque one within.
    tools.width = 2, tools.height = 1;
    tools.end_mm = {kNothing_mm, float(face + 8.3)};
    tools.endColour = {0, 0, 0, .2f, .4f, .6f};
    tools.first = {0, 2, 2};
    tools.layers = {{float(face - 3), .25f, 0, 0, .5f}, {float(face + 5.7), 0, .2f, 0, .25f}};
    c.job.tools = &tools;
  }
};

double shown(double mm) { return 1 - std::exp(-kDepth * mm); }

TEST(VolumeTools, BlendPassesThemInOrder) {
  for (const bool fast : {true, false}) {
    Block b;
    if (!fast) b.c.job.interpolation = Interpolation::Nearest;
    ASSERT_EQ(native::rendersFast(b.c.job), fast);
    for (const double step : {0.3, 1.0, 2.7}) {
      b.c.setStep(step);
      const Images i = b.c.draw();
      // Sheet, 5.7 mm, sheet, 14.3 mm, background.
      const double behind = .5 * (1 - shown(5.7));
      EXPECT_NEAR(i.colour[0],
                  .25 + .5 * shown(5.7) * .8 + .75 * behind * (shown(14.3) * .8 + (1 - shown(14.3)) * .1),
                  2e-5);
      EXPECT_NEAR(
          i.colour[1],
          .5 * shown(5.7) * .5 + behind * .2 + .75 * behind * (shown(14.3) * .5 + (1 - shown(14.3)) * .2),
          2e-5);
      EXPECT_NEAR(i.depth[0], b.face - 3, 1e-3);
      // 8.3 mm, then the sheet that ends the ray.
      EXPECT_NEAR(i.colour[6], shown(8.3) * .2 + (1 - shown(8.3)) * .6, 2e-5);
      EXPECT_NEAR(i.depth[1], b.face + 8.3, 1e-3);
    }
  }
}

TEST(VolumeTools, DepthIsWhereHalfIsPassed) {
  Block b;
  b.c.job.tools = nullptr;
  for (const double step : {0.3, 1.0, 2.7}) {
    b.c.setStep(step);
    EXPECT_NEAR(b.c.draw().depth[0], b.face + std::log(2.0) / kDepth, 1e-3);
  }
}

std::shared_ptr<const Volume> ramp() {
  VolumeInfo info;
  info.grid = test::unitGrid(21, 21, 21);
  std::vector<std::int16_t> v;
  for (int n = 0; n < 21 * 21 * 21; ++n) v.push_back(std::int16_t(10 * (n / 21 % 21)));  // by row
  return test::volumeOf(info, v);
}

TEST(VolumeTools, ExtremesAreColouredByTheFunction) {
  const TransferFunction f{{{0, {0, 1, 0}}, {200, {1, 0, 0}}}, {{0, .2}, {200, .6}}, 1};
  Block b(ramp(), f);
  b.c.job.mode = VolumeMode::Max;
  // The greatest value, 200, lies at the far face, behind both sheets; before the opaque one 83 are reached.
  Images i = b.c.draw();
  const double left = .5 * .75;
  EXPECT_NEAR(i.colour[0], .25 + left * (.6 * 1 + .4 * .1), 1e-5);
  EXPECT_NEAR(i.colour[1], .5 * .2 + left * (.6 * 0 + .4 * .2), 1e-5);
  EXPECT_NEAR(i.depth[0], b.face + 20, 1e-3);
  const double a = .2 + .4 * 83 / 200;
  EXPECT_NEAR(i.colour[4], a * .415 + (1 - a) * .2, 1e-4);
  EXPECT_NEAR(i.colour[5], a * .585 + (1 - a) * .4, 1e-4);
  b.c.job.mode = VolumeMode::Min;  // 0, at the near face, between the sheets
  i = b.c.draw();
  EXPECT_NEAR(i.colour[0], .25 + .5 * (.2 * 0 + .8 * .75 * .1), 1e-5);
  EXPECT_NEAR(i.colour[1], .5 * (.2 * 1 + .8 * (.2 + .75 * .2)), 1e-5);
}

std::shared_ptr<const Volume> colours(int channels) {
  VolumeInfo info;
  info.grid = test::unitGrid(21, 21, 21);
  std::vector<std::byte> v;
  for (int n = 0; n < 21 * 21 * 21; ++n) {
    const int row = n / 21 % 21;
    for (const int c : {10 * row, 100, 200 - 10 * row}) v.push_back(std::byte(c));
    if (channels == 4) v.push_back(std::byte(51));
  }
  return *Volume::makeColour(info, channels, v);
}

VolumeCase colourCase(int channels) {
  VolumeCase c;
  c.volume = colours(channels);
  c.job.volume = c.volume.get();
  const GridGeometry& grid = c.volume->grid();
  Camera camera;
  camera.height_mm = 1;
  c.job.camera = *cameraPicture(camera, {2, 1}, cameraBox(grid));
  c.job.region = *keptRegion({}, grid);
  c.job.background = {.1, .2, .3};
  c.job.leastLight = 0;
  return c;
}

TEST(VolumeTools, ColourVolumesBlend) {
  VolumeCase c = colourCase(4);
  c.job.gains = {1, 2, 1, .5};  // alpha .1 per mm
  for (const double step : {0.5, 0.125}) {
    c.job.step_mm = step;
    const Images i = c.draw();
    const double left = std::pow(.9, 20);
    EXPECT_NEAR(i.colour[1], 200 / 255.0 * (1 - left) + left * .2, 1e-5);
    // Red rises by 10 / 255 for each mm: the integral of exp(-d s) d s.
    const double d = -std::log(.9);
    const double red = 10 / 255.0 * (1 / d - left * (20 + 1 / d));
    EXPECT_NEAR(i.colour[0], red + left * .1, 0.02 * step * step);
  }
  c.job.gains[3] = 0;
  EXPECT_NEAR(c.draw().colour[2], .3, 1e-6);
  VolumeCase opaque = colourCase(3);
  EXPECT_NEAR(opaque.draw().colour[1], 100 / 255.0, 1e-6);
}

TEST(VolumeTools, ColourVolumesHaveExtremesByChannel) {
  VolumeCase c = colourCase(4);
  c.job.gains = {1.2, 10, .5, 1};
  c.job.mode = VolumeMode::Max, c.job.exact = true;
  Images i = c.draw();
  EXPECT_NEAR(i.colour[0], 1.2 * 200 / 255, 1e-5);
  EXPECT_NEAR(i.colour[1], 1, 1e-6);
  EXPECT_NEAR(i.colour[2], .5 * 200 / 255, 1e-5);
  c.job.mode = VolumeMode::Min;
  i = c.draw();
  EXPECT_NEAR(i.colour[0], 0, 1e-5);
  c.job.shading = ShadingModel::ColourPerVoxel;
  Images images;
  EXPECT_EQ(native::renderVolume(c.job, images).error().code, ErrorCode::Internal);
}

}  // namespace
}  // namespace vernier
