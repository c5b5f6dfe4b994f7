// SPDX-License-Identifier: GPL-3.0-or-later
// How a projection and tools combine, by hand: four voxels 0.2, 0.8, 0.4, 0.6, 1 mm apart along the ray.
#include <cmath>
#include <numbers>

#include "Brightness.h"
#include "VolumeScenes.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

constexpr double kGain = 0.25;  // per mm
constexpr Rgb kOlive{0.5, 0.9, 0}, kRed{1, 0, 0};
const glm::dvec3 olive(0.5, 0.9, 0);

VolumeScene projected(ProjectionMode mode) {
  ProjectionLayer layer;
  layer.mode = mode;
  layer.gain_perMm = kGain;
  return fourVoxels(layer);
}

constexpr ProjectionMode kAll[] = {ProjectionMode::Max, ProjectionMode::Min, ProjectionMode::Mean,
                                   ProjectionMode::Sum, ProjectionMode::Attenuation};

// What each mode makes of a ray without tools, from its extremes, integral and length.
glm::dvec3 alone(ProjectionMode mode, double max, double min, double integral, double length) {
  switch (mode) {
    case ProjectionMode::Max:
      return glm::dvec3(max);
    case ProjectionMode::Min:
      return glm::dvec3(min);
    case ProjectionMode::Mean:
      return glm::dvec3(integral / length);
    case ProjectionMode::Sum:
      return glm::dvec3(kGain * integral);
    case ProjectionMode::Attenuation:
      break;
  }
  return glm::dvec3(std::exp(-kGain * integral));
}

TEST(ProjectionReference, AloneClippedAndCropped) {
  for (const ProjectionMode mode : kAll) {
    SCOPED_TRACE(static_cast<int>(mode));
    VolumeScene s = projected(mode);
    s.scene.background = {0.1, 0.3, 1};  // takes no part where there are data, but in a sum
    const glm::dvec3 behind = mode == ProjectionMode::Sum ? glm::dvec3(0.1, 0.3, 1) : glm::dvec3(0);
    expectPixel(s, alone(mode, 0.8, 0.2, 1.6, 3) + behind);
    VolumeScene clipped = s;
    clipped.clipBefore(1.5);
    expectPixel(clipped, alone(mode, 0.6, 0.4, 0.75, 1.5) + behind);
    VolumeScene cropped = s;
    cropped.crop(0.4, 2.6);
    expectPixel(cropped, alone(mode, 0.8, 0.4, 1.248, 2.2) + behind);
    cropped.clipBefore(1.5);  // 0.6 .. 0.4 .. 0.52
    expectPixel(cropped, alone(mode, 0.6, 0.4, 0.25 + 0.276, 1.1) + behind);
    VolumeScene near = s;
    near.scene.camera.near_mm = 11.5;  // y = 1.5
    expectPixel(near, alone(mode, 0.6, 0.4, 0.75, 1.5) + behind);
    VolumeScene nothing = s;
    nothing.clipBefore(3.5);
    // A background of 1 that nothing has weakened, else the scene's.
    expectPixel(nothing, mode == ProjectionMode::Attenuation ? glm::dvec3(1) : glm::dvec3(0.1, 0.3, 1));
    EXPECT_FALSE(pixelOf(nothing).covered);
    EXPECT_TRUE(pixelOf(s).covered);
  }
}

TEST(ProjectionReference, AnOpaqueToolEndsTheRay) {
  const glm::dvec3 expected[] = {{0.8, 0.9, 0.8},
                                 {0.5, 0.9, 0.2},
                                 {0.652 / 1.2, 0.9, 0.652 / 1.2},
                                 olive + 0.163,
                                 std::exp(-0.163) * olive};
  for (std::size_t n = 0; n < 5; ++n) {
    SCOPED_TRACE(n);
    VolumeScene s = projected(kAll[n]);
    s.sheet(2.5, 1, {1, 1, 1});  // hidden by the nearer one
    s.sheet(1.2, 1, kOlive);     // 0.72 there
    expectPixel(s, expected[n]);
    VolumeScene before = projected(kAll[n]);
    before.sheet(-1, 1, kOlive);
    expectPixel(before, olive);
    EXPECT_TRUE(pixelOf(before).covered);
    VolumeScene behind = projected(kAll[n]);
    behind.sheet(7, 1, {0, 0, 0});  // black, so that it shows where it takes light away
    const glm::dvec3 black =
        kAll[n] == ProjectionMode::Attenuation ? glm::dvec3(0) : alone(kAll[n], 0.8, 0.2, 1.6, 3);
    expectPixel(behind, black);
  }
}

TEST(ProjectionReference, ATranslucentToolWeighsWhatIsBehindIt) {
  const double absorbed = std::exp(-kGain * 0.175), all = std::exp(-kGain * 1.6);
  const double mean = 1.6 / 3 * (0.5 + 0.75 * 2.5) / 3, sum = kGain * (0.175 + 0.75 * 1.425);
  const glm::dvec3 expected[] = {{0.25 + 0.75 * 0.8, 0.6, 0.6},
                                 {0.25 + 0.2, 0.2, 0.2},
                                 {0.25 + mean, mean, mean},
                                 {0.25 + sum, sum, sum},
                                 {0.25 * absorbed + 0.75 * all, 0.75 * all, 0.75 * all}};
  for (std::size_t n = 0; n < 5; ++n) {
    SCOPED_TRACE(n);
    VolumeScene s = projected(kAll[n]);
    s.sheet(0.5, 0.25, kRed);  // 0.5 there
    expectPixel(s, expected[n]);
    // One that lets all light through changes nothing.
    VolumeScene clear = projected(kAll[n]);
    clear.sheet(0.5, 1e-12, kRed);
    expectPixel(clear, alone(kAll[n], 0.8, 0.2, 1.6, 3));
  }
  VolumeScene dark = projected(ProjectionMode::Min);
  dark.sheet(0.5, 0.6, kRed);
  expectPixel(dark, {0.6 + 0.16, 0.16, 0.16});  // 0.4 * 0.4 behind is darker than 0.2 before
}

TEST(ProjectionReference, TranslucentBeforeOpaque) {
  // 0.25 of red at 0.5, olive at 1.2; in between 0.325 + 0.152 of emission, in front 0.175.
  const double behind = 0.75 * 0.9;
  const double mean = 0.652 / 1.2 * (0.5 + 0.75 * 0.7) / 1.2, sum = kGain * (0.175 + 0.75 * 0.477);
  const double a1 = std::exp(-kGain * 0.175), a2 = std::exp(-kGain * 0.652);
  const glm::dvec3 expected[] = {{0.25 + 0.6, behind, 0.6},
                                 {0.25 + 0.375, behind, 0.2},
                                 {0.25 + mean, behind, mean},
                                 {0.25 + sum + 0.375, sum + behind, sum},
                                 {0.25 * a1 + a2 * 0.375, a2 * behind, 0}};
  for (std::size_t n = 0; n < 5; ++n) {
    SCOPED_TRACE(n);
    VolumeScene s = projected(kAll[n]);
    s.sheet(1.2, 1, kOlive);
    s.sheet(0.5, 0.25, kRed);
    s.sheet(2, 0.5, {1, 1, 1});  // behind the opaque one
    expectPixel(s, glm::max(expected[n], glm::dvec3(0)));
  }
}

// Over the scene's background; a sum is taken from white, and an inverted radiograph starts at black.
TEST(ProjectionReference, ToolsWithoutData) {
  for (const bool invert : {false, true})
    for (const ProjectionMode mode : kAll) {
      VolumeScene s = projected(mode);
      s.projection().invert = invert;
      s.scene.background = {0.1, 0.2, 0.3};
      s.clipBefore(5);
      s.sheet(1, 0.25, kRed);
      glm::dvec3 behind(0.1, 0.2, 0.3);
      if (mode == ProjectionMode::Attenuation) behind = glm::dvec3(invert ? 0 : 1);
      if (mode == ProjectionMode::Sum && invert) behind = glm::dvec3(1);
      expectPixel(s, glm::dvec3(0.25, 0, 0) + 0.75 * behind);
    }
}

TEST(ProjectionReference, InvertKeepsTheToolsColours) {
  for (const bool byVolume : {false, true}) {
    const auto inverted = [&](ProjectionMode mode) {
      VolumeScene s = projected(mode);
      if (!byVolume) {
        s.projection().invert = true;
        return s;
      }
      VolumeInfo info;
      info.grid = gridOf(2, 4, 2);
      info.inverted = true;
      s.sources.volumes["v"] = floatVolume(info, [](auto, auto j, auto) { return kFour[j]; });
      return s;
    };
    for (const ProjectionMode mode : kAll) expectPixel(inverted(mode), 1.0 - alone(mode, 0.8, 0.2, 1.6, 3));
    VolumeScene max = inverted(ProjectionMode::Max);
    max.sheet(1.2, 1, kOlive);
    expectPixel(max, {0.2, 0.2, 0});  // 1 - max(0.8, 1 - olive)
    VolumeScene xray = inverted(ProjectionMode::Attenuation);
    xray.sheet(1.2, 1, kOlive);
    expectPixel(xray, 1.0 - std::exp(-0.163) * (1.0 - olive));
    VolumeScene sum = inverted(ProjectionMode::Sum);
    sum.projection().gain_perMm = 10;
    expectPixel(sum, {0, 0, 0});  // clamped before it is turned round
    VolumeScene bright = inverted(ProjectionMode::Max);
    bright.projection().invert = !bright.projection().invert;
    expectPixel(bright, glm::dvec3(0.8));  // twice is not at all
  }
}

// v = y / 4 on 0..3, z' = 1 - y / 3: the product is greatest in the middle of a cell.
TEST(ProjectionReference, TheCueIsPartOfTheMaximum) {
  const double ramp[4] = {0, 0.25, 0.5, 0.75};
  ProjectionLayer layer;
  layer.cue = 1;
  VolumeScene s = fourVoxels(layer, ramp);
  expectPixel(s, glm::dvec3(0.25 * 1.5 * 0.5), 1e-12);
  EXPECT_NEAR(pixelOf(s).value, 0.75, 1e-12);  // the value is that of the field
  s.projection().cue = 0.5;                    // y / 4 * (1 - y / 6): at the end
  expectPixel(s, glm::dvec3(0.375), 1e-12);
  // Saturated from y = 1.5 on: there it is brightest, with half of the cue.
  s.projection().cue = 1;
  s.projection().window = VoiWindow{0.1875, 0.375, VoiFunction::LinearExact, ""};
  expectPixel(s, glm::dvec3(0.5), 1e-9);
  // A window without width (LINEAR of width 1 around 0.75): 1 above 0.25, so from y = 1 on.
  s.projection().window = VoiWindow{0.75, 1, VoiFunction::Linear, ""};
  expectPixel(s, glm::dvec3(2.0 / 3), 1e-9);
  // A clip plane moves neither end of the cue.
  s.projection().window = unitWindow();
  s.clipBefore(2);
  expectPixel(s, glm::dvec3(0.5 / 3), 1e-12);
}

// Perspective: z' = (n f / d - n) / (f - n). v = y / 4, n = 10, f = 13, d = 10 + y: the greatest of y (3 - y)
// / (10 + y) * 10 / 12 lies where y^2 + 20 y = 30.
TEST(ProjectionReference, TheCueInPerspectiveIsLinearAfterProjection) {
  const double ramp[4] = {0, 0.25, 0.5, 0.75};
  ProjectionLayer layer;
  layer.cue = 1;
  VolumeScene s = fourVoxels(layer, ramp);
  s.scene.camera.projection = Projection::Perspective;
  const double y = std::sqrt(130.0) - 10;
  expectPixel(s, glm::dvec3(y / 4 * 10 * (3 - y) / (3 * (10 + y))), 1e-12);
  // The eye inside, nearer than a thousandth of the far depth to what it sees: z' stays at 1.
  s.scene.camera.distance_mm = 0;  // at y = 1.5
  s.projection().window = VoiWindow{0.1875, 0.375, VoiFunction::LinearExact, ""};
  expectPixel(s, glm::dvec3(1), 1e-12);
}

TEST(ProjectionReference, NearestIsConstantInEachCell) {
  for (const ProjectionMode mode : kAll) {
    VolumeScene s = projected(mode);
    s.projection().interpolation = Interpolation::Nearest;
    // Half a voxel of 0.2 and of 0.6, whole ones of 0.8 and 0.4.
    expectPixel(s, alone(mode, 0.8, 0.2, 0.1 + 0.8 + 0.4 + 0.3, 3));
    s.clipBefore(1.75);
    expectPixel(s, alone(mode, 0.6, 0.4, 0.75 * 0.4 + 0.3, 1.25));
  }
}

// The third voxel is no data: between the second and the fourth each keeps its value to the other's cell, and
// at the third itself nothing.
TEST(ProjectionReference, NoDataTakesNoPart) {
  VolumeInfo info;
  info.grid = gridOf(2, 4, 2);
  info.noData = NoDataRange{-5, -5};
  const auto holed = floatVolume(info, [](auto, auto j, auto) { return j == 2 ? -5.0 : kFour[j]; });
  for (const ProjectionMode mode : kAll) {
    VolumeScene s = projected(mode);
    s.sources.volumes["v"] = holed;
    expectPixel(s, alone(mode, 0.8, 0.2, 0.5 + 0.8 + 0.6, 3));
  }
  // All four gone: nothing is shown.
  VolumeScene none = projected(ProjectionMode::Attenuation);
  none.sources.volumes["v"] = floatVolume(info, [](auto, auto, auto) { return -5.0; });
  EXPECT_FALSE(pixelOf(none).covered);
  expectPixel(none, {1, 1, 1});
}

// A gap after the second of four slices at 0, 1, 3, 4: held for half a step on both sides.
TEST(ProjectionReference, GapsAreEmptyBeyondTheHold) {
  VolumeInfo info;
  info.grid = gridOf(2, 2, 4);
  info.grid.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1}, {0, 0, 3}, {0, 0, 4}};
  info.grid.gapAfter = {1};
  const auto v = floatVolume(info, [](auto, auto, auto k) { return kFour[k]; });
  for (const ProjectionMode mode : kAll) {
    VolumeScene s = projected(mode);
    s.sources.volumes["v"] = v;
    s.scene.camera.elevation_deg = 90;  // from above, slice 3 first
    expectPixel(s, alone(mode, 0.8, 0.2, 0.5 + 0.4 + 0.2 + 0.5, 3));
  }
}

TEST(ProjectionReference, AConstantVolumeHasTheLengthOfItsBox) {
  // 9 x 6 x 5 voxels of 1 x 2 x 3 mm, left-handed: the box of centres is 8 x 10 x 12 mm.
  GridGeometry g = gridOf(9, 6, 5, {1, 2, -3});
  ProjectionLayer layer;
  layer.mode = ProjectionMode::Sum;
  VolumeScene s = volumeScene(floatVolume(g, [](auto, auto, auto) { return 0.5; }), layer);
  const double diagonal = std::sqrt(64.0 + 100 + 144);
  expectPixel(s, glm::dvec3(4 / diagonal * 0.5 * 10), 1e-12);  // the gain as it is where none is given
  s.projection().gain_perMm = 0.05;
  s.scene.camera.azimuth_deg = 90;
  expectPixel(s, glm::dvec3(0.05 * 0.5 * 8), 1e-12);
  s.scene.camera.elevation_deg = -90;
  expectPixel(s, glm::dvec3(0.05 * 0.5 * 12), 1e-12);
  s.scene.camera.elevation_deg = 0, s.scene.camera.azimuth_deg = 30;  // corner to corner no more than 8 / sin
  expectPixel(s, glm::dvec3(0.05 * 0.5 * 10 / std::cos(std::numbers::pi / 6)), 1e-12);
  s.projection().mode = ProjectionMode::Attenuation;
  expectPixel(s, glm::dvec3(std::exp(-0.05 * 0.5 * 10 / std::cos(std::numbers::pi / 6))), 1e-12);
  // No half voxel around it: at 5.01 mm from the middle along x (box: 4) nothing.
  s.scene.camera.azimuth_deg = 0, s.scene.camera.pan_mm = {4.01, 0};
  EXPECT_FALSE(pixelOf(s).covered);
  s.scene.camera.pan_mm = {3.99, 0};
  EXPECT_TRUE(pixelOf(s).covered);
}

// A Gaussian blob, sampled finely: what a projection through its middle comes to tends to the closed forms.
TEST(ProjectionReference, AGaussianBlobTendsToItsClosedForms) {
  const double sigma = 4;
  double last = 1;
  for (const int n : {17, 33, 65}) {
    GridGeometry g = gridOf(n, n, n, glm::dvec3(40.0 / (n - 1)));
    g.patientFromVoxel.translation = glm::dvec3(-20);
    const auto v = floatVolume(g, [&](auto i, auto j, auto k) {
      const glm::dvec3 p = 40.0 / (n - 1) * glm::dvec3(i, j, k) - 20.0;
      return std::exp(-glm::dot(p, p) / (2 * sigma * sigma));
    });
    ProjectionLayer layer;
    layer.mode = ProjectionMode::Sum;
    layer.gain_perMm = 0.05;
    VolumeScene s = volumeScene(v, layer);
    s.scene.camera.azimuth_deg = 20, s.scene.camera.elevation_deg = 35, s.scene.camera.pan_mm = {3, -2};
    const double across = std::exp(-13 / (2 * sigma * sigma));
    const double truth = 0.05 * across * sigma * std::sqrt(2 * std::numbers::pi);
    const double error = std::abs(pixelOf(s).rgba.x - truth);
    EXPECT_LT(error, last / (n == 17 ? 1 : 3.5));  // trilinear: second order
    last = error;
    s.projection().mode = ProjectionMode::Max;
    EXPECT_NEAR(pixelOf(s).rgba.x, across, n == 65 ? 0.003 : 0.04);
  }
  EXPECT_LT(last, 1e-3);
}

// One cell from 0 to 1, a window of 0.25..0.75: the mean grey of a straight line is 1/2, the product with a
// falling cue is 2 (u - 1/4) (1 - u). Sigmoid: its integral is a logarithm.
TEST(Brightness, StraightLinesHaveClosedForms) {
  Piece line01;
  line01.end = 1;
  line01.numerator = line(0, 1);
  const VoiWindow narrow{0.5, 0.5, VoiFunction::LinearExact, ""};
  EXPECT_NEAR(meanGrey(line01, narrow), 0.5, 1e-14);
  const Cue falling{line(1, 0), Poly{{1}, 0}};
  EXPECT_NEAR(brightest(line01, narrow, falling, 0), 0.75 * 0.375, 1e-14);
  EXPECT_EQ(brightest(line01, narrow, falling, 0.3), 0.3);
  const VoiWindow sigmoid{0.4, 0.2, VoiFunction::Sigmoid, ""};
  const auto primitive = [](double x) { return std::log1p(std::exp(20 * (x - 0.4))) / 20; };
  EXPECT_NEAR(meanGrey(line01, sigmoid), primitive(1) - primitive(0), 1e-11);
  double best = 0;
  for (int n = 0; n <= 2000000; ++n) {
    const double u = n / 2e6;
    best = std::max(best, (1 - u) / (1 + std::exp(-20 * (u - 0.4))));
  }
  EXPECT_NEAR(brightest(line01, sigmoid, falling, 0), best, 2e-9);
}

TEST(ProjectionReference, WhatItCannotDrawIsRefused) {
  VolumeScene s = projected(ProjectionMode::Max);
  ReferenceOptions implementation;
  implementation.kind = ErrorKind::Implementation;
  EXPECT_EQ(refusalOf(s, implementation).code, ErrorCode::NotBuiltYet);
  VolumeScene two = s;
  two.scene.layers.push_back(two.scene.layers[0]);
  EXPECT_EQ(refusalOf(two).code, ErrorCode::NotBuiltYet);
  VolumeScene mixed = s;
  mixed.scene.layers.emplace_back(SliceLayer{});
  EXPECT_EQ(refusalOf(mixed).code, ErrorCode::NotBuiltYet);
  VolumeScene cubic = s;
  cubic.projection().interpolation = Interpolation::Cubic;
  EXPECT_EQ(refusalOf(cubic).code, ErrorCode::SceneInvalid);
  VolumeScene flat = s;
  flat.sources.volumes["v"] = floatVolume(gridOf(4, 4, 1), [](auto, auto, auto) { return 1.0; });
  EXPECT_EQ(refusalOf(flat).code, ErrorCode::GeometryRefused);
  VolumeScene crop = s;
  crop.crop(2, 1);
  EXPECT_EQ(refusalOf(crop).code, ErrorCode::SceneInvalid);
  VolumeScene clip = s;
  clip.scene.clip.push_back({PatientVec(0, 0, 0), 1});
  EXPECT_EQ(refusalOf(clip).code, ErrorCode::SceneInvalid);
  VolumeScene missing = s;
  missing.sources.volumes.clear();
  EXPECT_EQ(refusalOf(missing).code, ErrorCode::SceneInvalid);
  VolumeScene tool = s;
  tool.sheet(1, 1, kRed);
  tool.sources.meshes.clear();
  EXPECT_EQ(refusalOf(tool).code, ErrorCode::SceneInvalid);
  VolumeScene cue = s;
  cue.projection().cue = 2;
  EXPECT_EQ(refusalOf(cue).code, ErrorCode::SceneInvalid);
}

}  // namespace
}  // namespace vernier::quality
