// SPDX-License-Identifier: GPL-3.0-or-later
// Blended volumes and their extremes against closed forms and by hand: four voxels 0.2, 0.8, 0.4, 0.6, 1 mm
// apart along the ray, and fields that are straight lines.
#include <cmath>
#include <numbers>

#include "VolumeScenes.h"
#include "vernier/volume/Build.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

const glm::dvec3 kOrange(1, 0.5, 0.25);
constexpr Rgb kRed{1, 0, 0}, kOlive{0.5, 0.9, 0};

TransferFunction constantFunction(double opacity, glm::dvec3 colour = kOrange, double length_mm = 1) {
  return {{{0, colour}}, {{0, opacity}}, length_mm};
}
VolumeLayer layerOf(TransferFunction f) {
  VolumeLayer layer;
  layer.transfer = std::move(f);
  return layer;
}
const double kRamp[4] = {0, 1, 2, 3};  // the value is y

VolumeScene ramp(TransferFunction f) { return fourVoxels(layerOf(std::move(f)), kRamp); }

TEST(VolumeReference, AConstantOpacityAbsorbsByLength) {
  const double tau = -std::log(1 - 0.3) / 2;  // 0.3 over 2 mm
  const auto at = [&](double length) { return kOrange * -std::expm1(-tau * length); };
  VolumeScene s = fourVoxels(layerOf(constantFunction(0.3, kOrange, 2)));
  expectPixel(s, at(3), 1e-13);
  EXPECT_TRUE(pixelOf(s).covered);
  s.scene.background = {0.2, 0.4, 0.6};
  const glm::dvec3 behind(0.2, 0.4, 0.6);
  expectPixel(s, at(3) + std::exp(-3 * tau) * behind, 1e-13);
  VolumeScene clipped = s;
  clipped.clipBefore(1.3);
  expectPixel(clipped, at(1.7) + std::exp(-1.7 * tau) * behind, 1e-13);
  VolumeScene cropped = s;
  cropped.crop(0.4, 2.6);
  expectPixel(cropped, at(2.2) + std::exp(-2.2 * tau) * behind, 1e-13);
  VolumeScene near = s;
  near.scene.camera.near_mm = 11.5;
  expectPixel(near, at(1.5) + std::exp(-1.5 * tau) * behind, 1e-13);
  VolumeScene none = s;
  none.clipBefore(4);
  expectPixel(none, behind, 1e-15);
  EXPECT_FALSE(pixelOf(none).covered);
  VolumeScene clear = fourVoxels(layerOf(constantFunction(0)));
  clear.scene.background = {0.2, 0.4, 0.6};
  expectPixel(clear, behind, 1e-15);
  EXPECT_FALSE(pixelOf(clear).covered);
}

TEST(VolumeReference, PerspectiveAndTheEyeInside) {
  const double tau = -std::log(0.9);
  GridGeometry g = gridOf(9, 11, 9, {1, 1, 1});
  g.patientFromVoxel.translation = {-4, -5, -4};
  VolumeScene s =
      volumeScene(floatVolume(g, [](auto, auto, auto) { return 7.0; }), layerOf(constantFunction(0.1)));
  s.view = {64, 64};
  Camera& camera = s.scene.camera;
  camera.projection = Projection::Perspective;
  camera.fov_deg = 40, camera.distance_mm = 30;
  const auto lengthOf = [&](double px, double py, double from, double to) {  // in y
    const double k = 2 * std::tan(20 * std::numbers::pi / 180) / 64;
    return (to - from) * std::sqrt(1 + k * k * ((px - 32) * (px - 32) + (py - 32) * (py - 32)));
  };
  const auto at = [&](std::size_t x, std::size_t y) { return pixelOf(s, x + 64 * y).rgba.x; };
  EXPECT_NEAR(at(32, 32), -std::expm1(-tau * lengthOf(32.5, 32.5, -5, 5)), 1e-12);
  EXPECT_NEAR(at(28, 35), -std::expm1(-tau * lengthOf(28.5, 35.5, -5, 5)), 1e-12);
  camera.distance_mm = 0;
  EXPECT_NEAR(at(40, 30), -std::expm1(-tau * lengthOf(40.5, 30.5, 0, 5)), 1e-12);
  camera.near_mm = 2;
  EXPECT_NEAR(at(40, 30), -std::expm1(-tau * lengthOf(40.5, 30.5, 2, 5)), 1e-12);
}

// v = y, a = v / 4, d0 = 1: light left up to y is exp of the integral of ln(1 - y/4), which is -4 (w ln w -
// w) for w = 1 - y / 4. With a colour c = v / 3 the emission is parts of that, by integration by parts: C =
// [-c T] + integral of c' T.
TEST(VolumeReference, ALinearFieldWithALinearOpacity) {
  TransferFunction f{{{0, {1, 0, 0.5}}, {3, {1, 1, 0.5}}}, {{0, 0}, {4, 1}}, 1};
  const auto light = [](double y) {
    const double w = 1 - y / 4;
    return std::exp(-4 * (w * std::log(w) - w) - 4);
  };
  double integral = 0;  // of T over 0..3, Simpson
  constexpr int n = 20000;
  for (int k = 0; k <= n; ++k)
    integral += light(3.0 * k / n) * (k == 0 || k == n ? 1 : k % 2 ? 4 : 2) * 3.0 / n / 3;
  const double left = light(3);
  VolumeScene s = ramp(f);
  expectPixel(s, {1 - left, integral / 3 - left, 0.5 * (1 - left)}, 1e-9);
  // Opacity reaches 1 at y = 3, like a logarithm, which leaves light behind it.
  f.opacities = {{0, 0}, {3, 1}};
  VolumeScene singular = ramp(f);
  singular.scene.background = {0, 0, 1};
  const double behind = std::exp(-3.0);  // integral of -ln(1 - y/3) is 3
  EXPECT_NEAR(pixelOf(singular).rgba.x, 1 - behind, 1e-6);
  EXPECT_NEAR(pixelOf(singular).rgba.z, 0.5 * (1 - behind) + behind, 1e-6);
}

// A Gaussian, sampled more and more finely, tends to the integral through the smooth one.
TEST(VolumeReference, AGaussianTendsToItsIntegral) {
  const double sigma = 4;
  TransferFunction f{{{0, {0, 0.2, 1}}, {1, {1, 0.6, 0}}}, {{0, 0}, {1, 0.3}}, 1};
  const auto value = [&](double x, double r2) { return std::exp(-(x * x + r2) / (2 * sigma * sigma)); };
  glm::dvec3 truth(0);
  double left = 1;
  constexpr int steps = 200000;
  for (int n = 0; n < steps; ++n) {
    const double v = value(-20 + 40 * (n + 0.5) / steps, 13), h = 40.0 / steps;
    const double a = -std::expm1(std::log1p(-0.3 * v) * h);
    truth += left * a * glm::dvec3(v, 0.2 + 0.4 * v, 1 - v);
    left *= 1 - a;
  }
  double last = 1;
  for (const int n : {17, 33, 65}) {
    GridGeometry g = gridOf(n, n, n, glm::dvec3(40.0 / (n - 1)));
    g.patientFromVoxel.translation = glm::dvec3(-20);
    VolumeScene s = volumeScene(floatVolume(g,
                                            [&](auto i, auto j, auto k) {
                                              const glm::dvec3 p =
                                                  40.0 / (n - 1) * glm::dvec3(i, j, k) - 20.0;
                                              return std::exp(-glm::dot(p, p) / (2 * sigma * sigma));
                                            }),
                                layerOf(f));
    s.scene.camera.azimuth_deg = 20, s.scene.camera.elevation_deg = 35, s.scene.camera.pan_mm = {3, -2};
    const double error = glm::length(glm::dvec3(pixelOf(s).rgba) - truth);
    EXPECT_LT(error, last / (n == 17 ? 1 : 3.5));
    last = error;
  }
  EXPECT_LT(last, 3e-3);
}

// v = y. Clear below 1, then a half over 1 mm up to 2, then opaque and green.
TEST(VolumeReference, StepsAndWhatIsOpaqueAtOnce) {
  TransferFunction f{
      {{1, {1, 0, 0}}, {2, {1, 0, 0}}, {2, {0, 1, 0}}}, {{1, 0}, {1, 0.5}, {2, 0.5}, {2, 1}}, 1};
  VolumeScene s = ramp(f);
  s.scene.background = {0, 0, 1};
  expectPixel(s, {0.5, 0.5, 0}, 1e-13);
  s.clipBefore(1.5);
  expectPixel(s, {1 - std::sqrt(0.5), std::sqrt(0.5), 0}, 1e-13);
  VolumeScene inside = ramp(f);
  inside.clipBefore(2.5);
  expectPixel(inside, {0, 1, 0}, 1e-15);
  // From behind the opaque part comes first, and its colour is that of where it is met.
  TransferFunction shaded = f;
  shaded.colours = {{2, {0, 1, 0}}, {3, {0, 0, 1}}};
  VolumeScene behind = ramp(shaded);
  behind.scene.camera.azimuth_deg = 180;
  expectPixel(behind, {0, 0, 1}, 1e-13);
  behind.crop(-1, 2.5);
  expectPixel(behind, {0, 0.5, 0.5}, 1e-9);
  // Where it only touches 1 light gets through; where it stays there none does.
  TransferFunction touching{{{0, {1, 1, 1}}}, {{0, 0}, {3, 0}, {3, 1}}, 1};
  VolumeScene touched = ramp(touching);
  touched.scene.background = {0, 0, 1};
  expectPixel(touched, {0, 0, 1}, 1e-13);
  // At a step the later point holds: a field that stays at its value is opaque.
  const double flat[4] = {3, 3, 3, 3};
  VolumeScene held = fourVoxels(layerOf(touching), flat);
  expectPixel(held, {1, 1, 1}, 1e-15);
  TransferFunction turned{{{0, {1, 1, 1}}}, {{0, 1}, {3, 1}, {3, 0}}, 1};
  VolumeScene open = fourVoxels(layerOf(turned), flat);
  open.scene.background = {0, 0, 1};
  expectPixel(open, {0, 0, 1}, 1e-15);
}

// A thin peak of opacity inside a single cell: 0.02 of the value, whose ramps no fixed step would meet.
TEST(VolumeReference, AThinPeakIsNotSteppedOver) {
  TransferFunction f{{{0, {1, 1, 1}}}, {{1.49, 0}, {1.49, 0.999}, {1.51, 0.999}, {1.51, 0}}, 1};
  expectPixel(ramp(f), glm::dvec3(1 - std::pow(0.001, 0.02)), 1e-12);
  TransferFunction tent{{{0, {1, 1, 1}}}, {{1.49, 0}, {1.5, 0.5}, {1.51, 0}}, 1};
  // Integral of -ln(1 - a) over both sides: 2 * 0.01 / 0.5 * [(1-x) ln(1-x) + x] at x = 0.5.
  const double depth = 2 * 0.01 / 0.5 * (0.5 * std::log(0.5) + 0.5);
  expectPixel(ramp(tent), glm::dvec3(1 - std::exp(-depth)), 1e-10);
}

// A line in 65,536 points is still a line.
TEST(VolumeReference, ManyPointsAreFeasible) {
  TransferFunction few{{{0, {0, 0.5, 1}}, {3, {1, 0.5, 0}}}, {{0, 0.1}, {3, 0.7}}, 1};
  TransferFunction many = few;
  many.colours.clear(), many.opacities.clear();
  for (std::size_t n = 0; n < kMostTransferPoints; ++n) {
    const double v = 3.0 * static_cast<double>(n) / static_cast<double>(kMostTransferPoints - 1);
    many.colours.push_back({v, glm::mix(glm::dvec3(0, 0.5, 1), glm::dvec3(1, 0.5, 0), v / 3)});
    many.opacities.push_back({v, 0.1 + 0.2 * v});
  }
  expectPixel(ramp(many), glm::dvec3(pixelOf(ramp(few)).rgba), 1e-9);
}

TEST(VolumeReference, ToolsInTheirOrder) {
  const double tau = -std::log(1 - 0.3);
  const auto part = [&](double length) { return kOrange * -std::expm1(-tau * length); };
  const auto left = [&](double length) { return std::exp(-tau * length); };
  const glm::dvec3 red(1, 0, 0), olive(0.5, 0.9, 0), blue(0, 0, 1);
  VolumeScene s = fourVoxels(layerOf(constantFunction(0.3)));
  s.scene.background = {0, 0, 1};
  VolumeScene opaque = s;
  opaque.sheet(2.5, 1, {1, 1, 1});
  opaque.sheet(1.2, 1, kOlive);
  expectPixel(opaque, part(1.2) + left(1.2) * olive, 1e-12);
  VolumeScene thin = s;
  thin.sheet(0.5, 0.25, kRed);
  expectPixel(thin, part(0.5) + left(0.5) * (0.25 * red + 0.75 * (part(2.5) + left(2.5) * blue)), 1e-12);
  thin.sheet(1.2, 1, kOlive);
  thin.sheet(2, 0.5, {1, 1, 1});
  expectPixel(thin, part(0.5) + left(0.5) * (0.25 * red + 0.75 * (part(0.7) + left(0.7) * olive)), 1e-12);
  VolumeScene before = s;
  before.sheet(-1, 0.25, kRed);
  expectPixel(before, 0.25 * red + 0.75 * (part(3) + left(3) * blue), 1e-12);
  before.sheet(-2, 1, kOlive);
  expectPixel(before, olive, 1e-12);
  VolumeScene behind = s;
  behind.sheet(5, 0.5, kRed);
  behind.sheet(7, 1, kOlive);
  expectPixel(behind, part(3) + left(3) * (0.5 * red + 0.5 * olive), 1e-12);
  VolumeScene alone = behind;
  alone.clipBefore(4);
  expectPixel(alone, 0.5 * red + 0.5 * olive, 1e-12);
  EXPECT_TRUE(pixelOf(alone).covered);
}

TEST(VolumeReference, NearestIsConstantInEachCell) {
  TransferFunction f{
      {{0, {1, 1, 1}}}, {{0.3, 0}, {0.3, 0.1}, {0.5, 0.1}, {0.5, 0.4}, {0.7, 0.4}, {0.7, 0.8}}, 1};
  VolumeLayer layer = layerOf(f);
  layer.interpolation = Interpolation::Nearest;
  // 0.2 clear; 0.8 for 1 mm, 0.4 for 1 mm, 0.6 for half a mm.
  expectPixel(fourVoxels(layer), glm::dvec3(1 - 0.2 * 0.9 * std::sqrt(0.6)), 1e-13);
}

// The third voxel is no data; its neighbours keep their value up to it, and nothing is at it itself.
TEST(VolumeReference, NoDataTakesNoPart) {
  VolumeInfo info;
  info.grid = gridOf(2, 4, 2);
  info.noData = NoDataRange{-5, -5};
  TransferFunction f{{{0, {1, 1, 1}}}, {{0, 0}, {1, 1}}, 1};
  VolumeScene s =
      volumeScene(floatVolume(info, [](auto, auto j, auto) { return j == 2 ? -5.0 : 0.5; }), layerOf(f));
  s.scene.camera.distance_mm = 11.5, s.scene.camera.height_mm = 1;
  expectPixel(s, glm::dvec3(1 - std::pow(0.5, 3)), 1e-6);
  // Two of them are missing: 1 mm without anything.
  s.sources.volumes["v"] =
      floatVolume(info, [](auto, auto j, auto) { return j == 1 || j == 2 ? -5.0 : 0.5; });
  expectPixel(s, glm::dvec3(1 - std::pow(0.5, 2)), 1e-6);
}

TEST(VolumeReference, UnevenSlicesAndGaps) {
  VolumeInfo info;
  info.grid = gridOf(2, 2, 4);
  info.grid.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1}, {0, 0, 3}, {0, 0, 4}};
  info.grid.gapAfter = {1};
  VolumeScene s =
      volumeScene(floatVolume(info, [](auto, auto, auto) { return 0.5; }), layerOf(constantFunction(0.5)));
  s.scene.camera.elevation_deg = 90;
  expectPixel(s, kOrange * (1 - std::pow(0.5, 3)), 1e-12);  // 4 mm but for 1 mm in the gap
  info.grid.gapAfter.clear();
  s.sources.volumes["v"] = floatVolume(info, [](auto, auto, auto) { return 0.5; });
  expectPixel(s, kOrange * (1 - std::pow(0.5, 4)), 1e-12);
}

TEST(VolumeReference, ExtremesHaveTheirColourAtTheirOpacity) {
  // 0.2 .. 0.8 .. 0.4 .. 0.6
  TransferFunction f{{{0, {0, 0, 1}}, {1, {1, 0, 0}}}, {{0, 0}, {1, 0.5}}, 1};
  VolumeLayer layer = layerOf(f);
  layer.mode = VolumeMode::Max;
  VolumeScene s = fourVoxels(layer);
  s.scene.background = {0, 1, 0};
  const glm::dvec3 most(0.8, 0, 0.2), least(0.2, 0, 0.8), green(0, 1, 0);
  expectPixel(s, 0.4 * most + 0.6 * green, 1e-7);
  EXPECT_NEAR(pixelOf(s).value, 0.8, 1e-7);
  VolumeScene min = s;
  min.volume().mode = VolumeMode::Min;
  expectPixel(min, 0.1 * least + 0.9 * green, 1e-7);
  // A tool in front of the greatest value, and one behind it; an opaque one hides it and all beyond.
  VolumeScene front = s;
  front.sheet(0.5, 0.25, kRed);
  expectPixel(front, 0.25 * glm::dvec3(1, 0, 0) + 0.75 * (0.4 * most + 0.6 * green), 1e-7);
  VolumeScene back = s;
  back.sheet(1.5, 0.25, kRed);
  expectPixel(back, 0.4 * most + 0.6 * (0.25 * glm::dvec3(1, 0, 0) + 0.75 * green), 1e-7);
  back.sheet(0.5, 1, kOlive);
  expectPixel(back, 0.25 * glm::dvec3(0.5, 0, 0.5) + 0.75 * glm::dvec3(0.5, 0.9, 0), 1e-7);
  VolumeScene none = s;
  none.clipBefore(5);
  expectPixel(none, green, 1e-15);
}

// Red rises along y from 0 to 51, green is 51, blue 255, alpha 102.
VolumeScene colours(VolumeMode mode, std::array<double, 4> gains, int samples = 4) {
  std::vector<std::byte> bytes;
  for (int n = 0; n < 16; ++n) {
    const int y = n / 2 % 4;
    const int rgba[4] = {17 * y, 51, 255, 102};
    for (int c = 0; c < samples; ++c) bytes.push_back(static_cast<std::byte>(rgba[c]));
  }
  VolumeInfo info;
  info.grid = gridOf(2, 4, 2, {1, 1, 0.5});
  auto made = Volume::makeColour(info, samples, bytes);
  EXPECT_TRUE(made.ok());
  VolumeLayer layer;
  layer.mode = mode, layer.gains = gains;
  VolumeScene s = volumeScene(*made, layer);
  s.scene.camera.distance_mm = 11.5, s.scene.camera.height_mm = 0.5;
  return s;
}

TEST(VolumeReference, ColourVolumes) {
  // Alpha 0.4 over half a mm. Red y / 15.
  const double tau = -2 * std::log(0.6), left = std::exp(-3 * tau);
  const double red = (1 - left * (1 + 3 * tau)) / tau / 15;  // integral of tau y / 15 exp(-tau y)
  VolumeScene s = colours(VolumeMode::Blend, {1, 1, 1, 1});
  s.scene.background = {0, 0, 1};
  expectPixel(s, {red, 0.2 * (1 - left), 1}, 1e-9);
  // Gains are held at 1: red from y = 1.5 on.
  const double t1 = std::exp(-1.5 * tau), rising = (1 - t1 * (1 + 1.5 * tau)) / tau / 1.5;
  VolumeScene bright = colours(VolumeMode::Blend, {10, 2, 1, 1});
  expectPixel(bright, {rising + t1 - left, 0.4 * (1 - left), 1 - left}, 1e-9);
  // An alpha of 1 or more is opaque at once, with the colour of where it begins.
  VolumeScene opaque = colours(VolumeMode::Blend, {1, 1, 1, 3});
  expectPixel(opaque, {0, 0.2, 1}, 1e-12);
  opaque.clipBefore(1.5);
  expectPixel(opaque, {0.1, 0.2, 1}, 1e-12);
  expectPixel(colours(VolumeMode::Blend, {1, 1, 1, 1}, 3), {0, 0.2, 1}, 1e-12);  // without alpha: opaque
  VolumeScene clear = colours(VolumeMode::Blend, {1, 1, 1, 0});
  clear.scene.background = {0.1, 0.2, 0.3};
  expectPixel(clear, {0.1, 0.2, 0.3}, 1e-15);
  // Extremes by channel, without the background.
  VolumeScene max = colours(VolumeMode::Max, {2, 1, 1, 1});
  max.scene.background = {1, 1, 1};
  expectPixel(max, {0.4, 0.2, 1}, 1e-12);
  // As opaque things, each where it is first reached: green and blue at the beginning.
  max.sheet(1.5, 1, kOlive);
  expectPixel(max, {0.2, 0.2, 1}, 1e-12);
  max.sheet(1.2, 0.25, {1, 0, 1});
  expectPixel(max, {0.25 + 0.75 * 0.2, 0.2, 1}, 1e-12);
  max.sheet(-1, 0.5, {0, 1, 0});
  expectPixel(max, {0.5 * (0.25 + 0.75 * 0.2), 0.5 + 0.5 * 0.2, 0.5}, 1e-12);
  VolumeScene min = colours(VolumeMode::Min, {2, 1, 1, 1});
  min.clipBefore(0.75);
  expectPixel(min, {0.1, 0.2, 1}, 1e-12);
  min.clipBefore(5);
  min.scene.background = {0.1, 0.2, 0.3};
  expectPixel(min, {0.1, 0.2, 0.3}, 1e-12);
}

TEST(VolumeReference, WhatItCannotDrawIsRefused) {
  VolumeScene s = fourVoxels(layerOf(constantFunction(0.3)));
  VolumeScene combined = s;
  combined.volume().combiner = "phong";
  EXPECT_EQ(refusalOf(combined).code, ErrorCode::NotBuiltYet);
  VolumeScene unnamed = s;
  unnamed.volume().transfer.reset();
  unnamed.volume().preset = "nonesuch";
  EXPECT_EQ(refusalOf(unnamed).code, ErrorCode::OptionInvalid);
  VolumeScene wrong = s;
  wrong.volume().transfer->opacities[0].opacity = std::nan("");
  EXPECT_EQ(refusalOf(wrong).code, ErrorCode::SceneInvalid);
  VolumeScene cubic = s;
  cubic.volume().interpolation = Interpolation::Cubic;
  EXPECT_EQ(refusalOf(cubic).code, ErrorCode::SceneInvalid);
  VolumeScene lit = colours(VolumeMode::Blend, {1, 1, 1, 1});
  lit.volume().shading = ShadingModel::ColourPerVoxel;
  EXPECT_EQ(refusalOf(lit).code, ErrorCode::NotBuiltYet);
  VolumeScene gain = colours(VolumeMode::Blend, {1, -1, 1, 1});
  EXPECT_EQ(refusalOf(gain).code, ErrorCode::SceneInvalid);
  ReferenceOptions sampled;
  sampled.kind = ErrorKind::Implementation;
  EXPECT_EQ(refusalOf(s, sampled).code, ErrorCode::NotBuiltYet);  // the planner chooses the classification
  VolumeScene max = s;
  max.volume().classification = Classification::Post;
  max.volume().mode = VolumeMode::Max;
  EXPECT_EQ(refusalOf(max, sampled).code, ErrorCode::NotBuiltYet);
}

// A preset by name, and the one that is taken where there is none.
TEST(VolumeReference, Presets) {
  VolumeLayer layer;
  VolumeScene s = fourVoxels(layer);
  const glm::dvec3 unnamed(pixelOf(s).rgba);
  s.volume().transfer = *transferPreset("ramp", *s.sources.volumes["v"]);
  expectPixel(s, unnamed, 1e-15);
  EXPECT_GT(unnamed.x, 0.1);
  s.volume().transfer.reset(), s.volume().preset = "mr";
  EXPECT_GT(glm::length(glm::dvec3(pixelOf(s).rgba) - unnamed), 0.01);
}

}  // namespace
}  // namespace vernier::quality
