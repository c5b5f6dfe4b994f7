// SPDX-License-Identifier: GPL-3.0-or-later
// How shells and tools combine, by hand: four voxels 0.2, 0.8, 0.4, 0.6, 1 mm apart along the ray, and levels
// 0.3, 0.5, 0.7.
#include <cmath>
#include <numbers>

#include "VolumeScenes.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

constexpr Rgb kOlive{0.5, 0.9, 0}, kRed{1, 0, 0};
const glm::dvec3 olive(0.5, 0.9, 0);

VolumeScene shells(ShellsMode mode) {
  ShellsLayer layer;
  layer.mode = mode;
  layer.levels = {0.3, 0.5, 0.7};
  return fourVoxels(layer);
}

TEST(ShellsReference, MaxIsTheTrueMaximum) {
  VolumeScene s = shells(ShellsMode::Max);
  s.scene.background = {0.1, 0.3, 1};
  expectPixel(s, glm::dvec3(0.8));
  VolumeScene clipped = s;
  clipped.clipBefore(1.5);
  expectPixel(clipped, glm::dvec3(0.6));  // a cap shows what the plane cuts open
  VolumeScene cropped = s;
  cropped.crop(1.5, 2.6);
  expectPixel(cropped, glm::dvec3(0.6));
  VolumeScene nothing = s;
  nothing.clipBefore(9);
  expectPixel(nothing, {0.1, 0.3, 1});
  nothing.shells().beta0 = 0.5, nothing.shells().phi0 = 0.4;
  expectPixel(nothing, {0.2, 0.3, 1});
  s.shells().colour = {0.5, 1, 0};
  expectPixel(s, {0.4, 0.8, 0});
  // phi0 behind all: at least beta0 phi0. b = phi (beta0 + betaM b).
  s.shells().beta0 = 0.5, s.shells().phi0 = 4, s.shells().b = 0.1;
  expectPixel(s, {1, 2, 0});
  s.shells().phi0 = 0.1;
  expectPixel(s, {0.5 * 0.8 * 0.6, 0.8 * 0.6, 0});
}

TEST(ShellsReference, MaxReplacesAToolBehindTheLowestLevel) {
  VolumeScene s = shells(ShellsMode::Max);
  s.shells().phi0 = 1, s.shells().beta0 = 1;  // takes no part before a tool
  s.shells().b = 0;
  s.sheet(1.2, 1, kOlive);
  expectPixel(s, glm::dvec3(0.8));  // though the tool is brighter in green
  VolumeScene front = shells(ShellsMode::Max);
  front.sheet(0.1, 1, kOlive);  // 0.26 before it
  expectPixel(front, olive);
  front.shells().levels = {0.25, 0.7};
  expectPixel(front, glm::dvec3(0.26));
  front.shells().disabled = {0};
  expectPixel(front, olive);
  VolumeScene translucent = shells(ShellsMode::Max);
  translucent.sheet(0.5, 0.25, kRed);
  expectPixel(translucent, {0.25 + 0.6, 0.6, 0.6});
  translucent.shells().beta0 = 1, translucent.shells().b = 0, translucent.shells().phi0 = 1;
  expectPixel(translucent, {1, 0.75, 0.75});  // beta0 phi0 lies behind the tool
  VolumeScene both = shells(ShellsMode::Max);
  both.sheet(0.1, 1, kOlive);
  both.sheet(0.05, 0.25, kRed);
  expectPixel(both, {0.25 + 0.375, 0.675, 0});
}

TEST(ShellsReference, TheBrighterOfShellsAndToolWhereThatIsAskedFor) {
  VolumeScene s = shells(ShellsMode::Max);
  s.shells().surfaceBlend = SurfaceBlend::Max;
  s.shells().phi0 = 1, s.shells().beta0 = 1, s.shells().b = 0;  // behind the tool: takes no part
  s.sheet(1.2, 1, kOlive);
  expectPixel(s, {0.8, 0.9, 0.8});
  s.shells().colour = {0.5, 1, 0.25};
  expectPixel(s, {0.5, 0.9, 0.2});
  // A translucent tool before the opaque one weakens both: 0.25 red + 0.75 max(0.8, olive).
  VolumeScene both = shells(ShellsMode::Max);
  both.shells().surfaceBlend = SurfaceBlend::Max;
  both.sheet(1.2, 1, kOlive);
  both.sheet(0.05, 0.25, kRed);
  expectPixel(both, {0.25 + 0.6, 0.75 * 0.9, 0.6});
  // Without an opaque tool nothing changes.
  VolumeScene translucent = shells(ShellsMode::Max);
  translucent.shells().surfaceBlend = SurfaceBlend::Max;
  translucent.sheet(0.5, 0.25, kRed);
  expectPixel(translucent, {0.25 + 0.6, 0.6, 0.6});
}

TEST(ShellsReference, MaxWithTheCue) {
  const double ramp[4] = {0, 0.25, 0.5, 0.75};
  ShellsLayer layer;
  layer.levels = {0.5};
  layer.a = 1, layer.b = 0;
  VolumeScene s = fourVoxels(layer, ramp);
  expectPixel(s, glm::dvec3(0.1875), 1e-12);  // y / 4 (1 - y / 3)
  s.scene.camera.projection = Projection::Perspective;
  const double y = std::sqrt(130.0) - 10;
  expectPixel(s, glm::dvec3(y / 4 * 10 * (3 - y) / (3 * (10 + y))), 1e-12);
  s.shells().cueByDistance = true;
  expectPixel(s, glm::dvec3(0.1875), 1e-12);
}

TEST(ShellsReference, SumCountsEveryCrossing) {
  VolumeScene s = shells(ShellsMode::Sum);
  s.scene.background = {0, 0, 1};
  // In 0.3 0.5 0.7, out 0.7 0.5, in 0.5, and out of 0.5 and 0.3 where the volume ends.
  expectPixel(s, glm::dvec3(4.0));
  VolumeScene clipped = s;
  clipped.clipBefore(1.5);  // begins at 0.6
  expectPixel(clipped, glm::dvec3(0.8 + 0.5 + 0.5 + 0.8));
  VolumeScene cropped = s;
  cropped.crop(0.4, 2.6);  // 0.44 .. 0.52
  expectPixel(cropped, glm::dvec3(0.3 + 1.2 + 1.2 + 0.5 + 0.8));
  VolumeScene opaque = s;
  opaque.sheet(1.2, 1, kOlive);  // no cap at a tool
  expectPixel(opaque, 1.5 + olive);
  VolumeScene translucent = s;
  translucent.sheet(1.2, 0.25, kRed);
  const double sum = 1.5 + 0.75 * 2.5;
  expectPixel(translucent, {0.25 + sum, sum, sum});
  VolumeScene none = s;
  none.shells().levels = {0.9};
  expectPixel(none, {0, 0, 1});
  EXPECT_FALSE(pixelOf(none).covered);
  VolumeScene fewer = s;
  fewer.shells().disabled = {1};
  expectPixel(fewer, glm::dvec3(0.3 + 0.7 + 0.7 + 0.3));
  // z' of the crossings: 0.3 at y = 1/6; 0.7 at 5/6 and 1.25; out at 3.
  fewer.shells().a = 1, fewer.shells().b = 0;
  const auto z = [](double y) { return 1 - y / 3; };
  expectPixel(fewer, glm::dvec3(0.3 * z(1.0 / 6) + 0.7 * z(5.0 / 6) + 0.7 * z(1.25)));
}

// The third voxel is no data: shells close there. 0.8 is held to it from one side, 0.6 from the other.
TEST(ShellsReference, ShellsCloseAtNoData) {
  VolumeInfo info;
  info.grid = gridOf(2, 4, 3);
  info.grid.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1}, {0, 0, 4}};
  info.grid.gapAfter = {1};
  VolumeScene s = shells(ShellsMode::Sum);
  s.sources.volumes["v"] =
      floatVolume(info, [](auto, auto, auto k) { return 0.4 + 0.2 * static_cast<double>(k); });
  s.scene.camera.elevation_deg = 90;
  s.scene.camera.target = PatientPoint(0.5, 1.5, 2);
  // From above: 0.8 held for half a step, then the gap, then 0.6 held, then down to 0.4.
  expectPixel(s, glm::dvec3(1.5 + 1.5 + 0.8 + 0.5 + 0.3));
  s.shells().mode = ShellsMode::Lit;
  s.shells().levels = {0.9};
  EXPECT_FALSE(pixelOf(s).covered);
  s.shells().levels = {0.5};
  s.crop(-1, 9);
  s.scene.crop->greatest.p.z = 3;  // only the gap and what is below it
  s.scene.camera.elevation_deg = 30, s.scene.camera.azimuth_deg = 0;
  // Enters where the hold of the second slice begins: a face across z.
  EXPECT_NEAR(pixelOf(s).rgba.x, 0.2 + 0.8 * 0.5, 1e-12);
}

TEST(ShellsReference, LitIsTheFirstShell) {
  VolumeScene s = shells(ShellsMode::Lit);
  s.shells().colour = {0.4, 0.5, 0.6};
  const glm::dvec3 colour(0.4, 0.5, 0.6);
  expectPixel(s, colour);
  for (const double elevation : {20.0, -50.0}) {
    VolumeScene tilted = s;  // the field falls along y, however the ray comes
    tilted.scene.camera.elevation_deg = elevation;
    const double cosine = std::cos(elevation * std::numbers::pi / 180);
    tilted.crop(0.01, 9);  // so that the ray enters through the face across y
    tilted.scene.camera.target = PatientPoint(0.5, 0.1, 0.5);
    expectPixel(tilted, (0.2 + 0.8 * cosine) * colour, 1e-9);
  }
  VolumeScene clipped = s;  // an oblique plane opens the shells: lit as the face that it makes
  const double c = 0.5, k = std::sqrt(0.75);
  clipped.scene.clip.push_back({PatientVec(0, -c, k), -c * 1.5 + k * 0.5});
  expectPixel(clipped, (0.2 + 0.8 * c) * colour);
  VolumeScene near = s;
  near.scene.camera.near_mm = 11;
  expectPixel(near, colour);
  VolumeScene opaque = s;
  opaque.sheet(1.2, 1, kOlive);
  expectPixel(opaque, colour);
  opaque.sheet(0.1, 1, kOlive);  // before 1/6, where the first shell is
  expectPixel(opaque, olive);
  VolumeScene translucent = s;
  translucent.sheet(0.1, 0.25, kRed);
  translucent.sheet(1.2, 0.5, kRed);  // hidden
  expectPixel(translucent, glm::dvec3(0.25, 0, 0) + 0.75 * colour);
  VolumeScene nothing = s;
  nothing.scene.background = {0, 0, 1};
  nothing.shells().levels = {0.9};
  expectPixel(nothing, {0, 0, 1});
  nothing.sheet(1.2, 0.25, kRed);
  expectPixel(nothing, {0.25, 0, 0.75});
}

// A ball of radius 8: value falls with the distance to the middle, so the shell of 12 - r = 4 is the ball.
TEST(ShellsReference, ABallIsLitAsABall) {
  const int n = 49;
  GridGeometry g = gridOf(n, n, n, glm::dvec3(0.5, 0.5, -0.5));
  g.patientFromVoxel.linear = glm::dmat3(0.5, 0, 0, 0, 0.5, 0, 0.1, -0.15, -0.5);  // sheared, left-handed
  const glm::dvec3 middle = (g.patientFromVoxel * VoxelPoint(24, 24, 24)).p;
  const auto v = floatVolume(g, [&](auto i, auto j, auto k) {
    return 12 - glm::length((g.patientFromVoxel * VoxelPoint(i, j, k)).p - middle);
  });
  ShellsLayer layer;
  layer.mode = ShellsMode::Lit;
  layer.levels = {4};
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
    VolumeScene s = volumeScene(v, layer);
    s.scene.camera.projection = projection;
    s.scene.camera.azimuth_deg = 40, s.scene.camera.elevation_deg = -30, s.scene.camera.roll_deg = 15;
    s.scene.camera.distance_mm = 60, s.scene.camera.height_mm = 20, s.scene.camera.fov_deg = 25;
    s.view = {21, 21};
    int hits = 0;
    for (std::size_t p = 0; p < 441; ++p) {
      const double x = static_cast<double>(p % 21) - 10, y = static_cast<double>(p / 21) - 10;
      const double step =
          (projection == Projection::Perspective ? 2 * std::tan(12.5 * std::numbers::pi / 180) : 20) / 21;
      // The ray's distance from the middle.
      const double slope = step * std::hypot(x, y);
      const double distance =
          projection == Projection::Perspective ? 60 * slope / std::hypot(1, slope) : slope;
      if (distance > 7.2) continue;
      ++hits;
      const double cosine = std::sqrt(1 - distance * distance / 64);
      EXPECT_NEAR(pixelOf(s, p).rgba.x, 0.2 + 0.8 * cosine, 0.03) << p;
    }
    EXPECT_GT(hits, 100);
  }
}

TEST(ShellsReference, WhatItCannotDrawIsRefused) {
  VolumeScene s = shells(ShellsMode::Max);
  ReferenceOptions implementation;
  implementation.kind = ErrorKind::Implementation;
  EXPECT_EQ(refusalOf(s, implementation).code, ErrorCode::NotBuiltYet);
  s.shells().levels = {0.5, 0.5};
  EXPECT_EQ(refusalOf(s).code, ErrorCode::SceneInvalid);
  s.shells().levels = {0.5};
  s.shells().betaM = -1;
  EXPECT_EQ(refusalOf(s).code, ErrorCode::SceneInvalid);
  s.shells().betaM = 1;
  s.shells().disabled = {0};  // nothing is left
  EXPECT_FALSE(pixelOf(s).covered);
}

}  // namespace
}  // namespace vernier::quality
