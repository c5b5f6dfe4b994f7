// SPDX-License-Identifier: GPL-3.0-or-later
// Where layers that look through a volume are measured, which pixels count as edges, and that the badge sees
// what is wrong.
#include <algorithm>

#include "VolumeMeasure.h"
#include "vernier/base/Random.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

// 41 x 33 x 25 voxels, bright only in a ball in one corner: most of the volume shows black.
VolumeScene ballScene(ProjectionMode mode) {
  GridGeometry g = gridOf(41, 33, 25, {1, 1, 1.5});
  ProjectionLayer layer;
  layer.mode = mode;
  VolumeScene s = volumeScene(floatVolume(g,
                                          [&](auto i, auto j, auto k) {
                                            const glm::dvec3 p(i - 8, j - 8, k - 6);
                                            return glm::length(p) < 4 ? 1.0 : 0.0;
                                          }),
                              layer);
  s.view = {80, 60};
  s.scene.camera.azimuth_deg = 30, s.scene.camera.elevation_deg = 20;
  return s;
}

TEST(VolumePopulation, HoldsAllThatShowsAndNotTheBlackRest) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const bool cut : {false, true})
      for (const ProjectionMode mode : {ProjectionMode::Max, ProjectionMode::Sum, ProjectionMode::Mean}) {
        VolumeScene s = ballScene(mode);
        s.scene.camera.projection = projection;
        if (cut) s.scene.crop = CropBox{VoxelPoint(0, 0, 0), VoxelPoint(11, 40, 40)};
        const std::vector<char> mask = maskOf(s);
        const Frame frame = frameOf(s);
        std::size_t lit = 0;
        for (std::size_t n = 0; n < mask.size(); ++n)
          if (frame.images.colour[4 * n] > 0) {
            ++lit;
            EXPECT_TRUE(mask[n]) << n;
          }
        EXPECT_GT(lit, 20u);
        // Of a mean all that has data counts, of the others only the bricks around the ball.
        if (mode != ProjectionMode::Mean) {
          EXPECT_LT(countOf(mask), mask.size() / 4);
        }
      }
}

TEST(VolumePopulation, WhatLooksUnlikeTheBackgroundCountsThoughItIsBlack) {
  VolumeScene s = ballScene(ProjectionMode::Max);
  const std::size_t bright = countOf(maskOf(s));
  s.scene.background = {0, 0, 0.2};
  const std::size_t all = countOf(maskOf(s));
  EXPECT_GT(all, 3 * bright);
  s.scene.background = {};
  s.projection().invert = true;
  EXPECT_EQ(countOf(maskOf(s)), all);
  // What emits nothing weakens nothing either.
  s.projection().mode = ProjectionMode::Attenuation;
  EXPECT_EQ(countOf(maskOf(s)), bright);
  s.scene.clip.push_back({PatientVec(1, 0, 0), -1});  // nothing is left
  EXPECT_EQ(countOf(maskOf(s)), 0u);
  s.sheet(0, 0.5, {1, 0, 0}, 5);  // but a tool
  EXPECT_GT(countOf(maskOf(s)), 100u);
}

TEST(VolumePopulation, TheEyeInsideSeesEverywhere) {
  VolumeScene s = ballScene(ProjectionMode::Mean);
  s.scene.camera.projection = Projection::Perspective;
  s.scene.camera.distance_mm = 0;
  const std::vector<char> mask = maskOf(s);
  EXPECT_EQ(countOf(mask), mask.size());
}

TEST(VolumePopulation, UnevenSlicesAreWhereTheyLie) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto draw = [&](std::uint64_t n) { return randomUnit(seed, n) - 0.5; };
    VolumeInfo info;
    info.grid = gridOf(12, 10, 4, {1, 1, 3});
    info.grid.sliceOrigin_vox = {
        {0, 0, 0}, {4 * draw(0), 4 * draw(1), 1.3}, {4 * draw(2), 4 * draw(3), 2.1}, {0, 0, 3}};
    info.noData = NoDataRange{-9, -9};
    ProjectionLayer layer;
    VolumeScene s = volumeScene(
        floatVolume(info, [&](auto i, auto, auto k) { return i > 8    ? -9.0
                                                             : k == 1 ? 1.0
                                                                      : 0.0; }), layer);
    s.view = {64, 48};
    s.scene.camera.azimuth_deg = 360 * draw(4), s.scene.camera.elevation_deg = 160 * draw(5);
    s.scene.camera.projection = seed % 2 ? Projection::Perspective : Projection::Orthographic;
    const std::vector<char> mask = maskOf(s);
    const Frame frame = frameOf(s);
    for (std::size_t n = 0; n < mask.size(); ++n)
      EXPECT_TRUE(mask[n] || !(frame.images.colour[4 * n] > 0)) << seed << ' ' << n;
  }
}

TEST(VolumeBadge, SeesWhatIsWrong) {
  for (const ProjectionMode mode : {ProjectionMode::Max, ProjectionMode::Sum, ProjectionMode::Attenuation}) {
    VolumeScene s = ballScene(mode);
    s.projection().gain_perMm = 0.05;
    const Frame frame = frameOf(s);
    const ErrorReport right = measured(frame, s);
    EXPECT_TRUE(right.exhaustive);
    EXPECT_LT(right.max, 1e-4);
    EXPECT_GT(right.population, 0u);
    VolumeScene nearest = s;
    nearest.projection().interpolation = Interpolation::Nearest;
    EXPECT_GT(measured(frame, nearest).max, 5);
    VolumeScene turned = s;
    turned.scene.camera.roll_deg = 2;
    EXPECT_GT(measured(frame, turned).max, 20);
    VolumeScene louder = s;
    louder.projection().gain_perMm = 0.055;
    EXPECT_EQ(measured(frame, louder).max > 2, mode != ProjectionMode::Max);
    VolumeScene cut = s;
    cut.scene.clip.push_back({PatientVec(-1, 0, 0), -8});  // through the ball's middle
    EXPECT_GT(measured(frame, cut).max, 20);
  }
}

// Edges: the outline of the data, of a tool, and of a cut face; never the inside.
TEST(VolumeBadge, EdgesAreOutlinesOfDataToolsAndCuts) {
  VolumeScene s =
      volumeScene(floatVolume(gridOf(21, 21, 21), [](auto, auto, auto) { return 0.5; }), ProjectionLayer{});
  s.view = {40, 40};
  s.scene.camera.height_mm = 40;  // the volume covers 20 x 20 pixels
  const auto edges = [&](const VolumeScene& scene) {
    const ErrorReport r = measured(frameOf(scene), scene);
    return static_cast<int>(std::lround(r.edge.share * static_cast<double>(r.n)));
  };
  EXPECT_EQ(edges(s), (22 * 22 - 18 * 18));  // a ring of two pixels around 20 x 20
  VolumeScene tool = s;
  SurfaceLayer& sheet = tool.sheet(-5, 1, {1, 1, 1}, 4);  // 8 x 8 pixels in the middle
  sheet.pose.translation = {10, 0, 10};
  EXPECT_EQ(edges(tool), (22 * 22 - 18 * 18) + (10 * 10 - 6 * 6));
  VolumeScene cut = s;  // an oblique plane, seen as a face over the right half: x >= 10
  cut.scene.clip.push_back({PatientVec(0.6, -0.8, 0), 0.6 * 10});
  EXPECT_EQ(edges(cut), (22 * 22 - 18 * 18) + 2 * 18);
  VolumeScene ball = s;
  ShellsLayer shells;
  shells.source = "v", shells.window = unitWindow(), shells.levels = {0.5};
  shells.mode = ShellsMode::Lit;
  ball.scene.layers[0] = shells;
  ball.sources.volumes["v"] = floatVolume(gridOf(21, 21, 21), [](auto i, auto j, auto k) {
    return glm::length(glm::dvec3(i - 10, j - 10, k - 10)) < 6 ? 1.0 : 0.0;
  });
  const int outline = edges(ball);
  EXPECT_GT(outline, 40);  // of a disc of 12 pixels, two wide
  EXPECT_LT(outline, 100);
}

TEST(VolumeBadge, ShellsAreMeasuredWhereALevelIsReached) {
  VolumeScene s = ballScene(ProjectionMode::Max);
  ShellsLayer shells;
  shells.source = "v", shells.window = unitWindow(), shells.count = 6;
  const std::size_t dim = countOf(maskOf(s));
  for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum, ShellsMode::Lit}) {
    shells.mode = mode;
    s.scene.layers[0] = shells;
    EXPECT_EQ(countOf(maskOf(s)), dim);
    const Frame frame = frameOf(s);
    EXPECT_LT(measured(frame, s).max, 1e-4);
    VolumeScene other = s;
    other.shells().levels = {0.999};
    // The true maximum does not know of levels.
    EXPECT_EQ(measured(frame, other).max > 1, mode != ShellsMode::Max);
  }
}

}  // namespace
}  // namespace vernier::quality
