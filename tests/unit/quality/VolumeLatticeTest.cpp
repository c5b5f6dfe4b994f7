// SPDX-License-Identifier: GPL-3.0-or-later
// Blended volumes as an engine samples them: the lattice by hand, and how it tends to the truth.
#include <cmath>

#include "VolumeScenes.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

constexpr Rgb kRed{1, 0, 0};
const TransferFunction kLine{{{0, {0, 0.5, 1}}, {3, {1, 0.5, 0}}}, {{0, 0}, {4, 1}}, 1};
const double kRamp[4] = {0, 1, 2, 3};

VolumeScene sampledScene() {
  VolumeLayer layer;
  layer.transfer = kLine;
  layer.classification = Classification::Post;
  return fourVoxels(layer, kRamp);
}
glm::dvec3 sampled(const VolumeScene& s, double step) {
  ReferenceOptions options;
  options.kind = ErrorKind::Implementation;
  options.step = step;
  const std::size_t pixel = 0;
  const auto p = referencePixels(s.scene, s.view, s.sources, std::span(&pixel, 1), options);
  EXPECT_TRUE(p.ok()) << (p.ok() ? "" : p.error().text());
  return p.ok() ? glm::dvec3((*p)[0].rgba) : glm::dvec3(-1);
}
// Red of samples (value, share of a mm), front to back.
double composited(const std::vector<std::pair<double, double>>& samples, double* left = nullptr) {
  double colour = 0, light = 1;
  for (const auto& [value, length] : samples) {
    const double a = 1 - std::pow(1 - value / 4, length);
    colour += light * a * value / 3, light *= 1 - a;
  }
  if (left) *left = light;
  return colour;
}

// The eye plane lies at y = -10, the volume at 0..3.
TEST(VolumeLattice, SamplesLieAtHalfSteps) {
  VolumeScene s = sampledScene();
  double left = 1;
  EXPECT_NEAR(sampled(s, 1).x, composited({{0.5, 1}, {1.5, 1}, {2.5, 1}}, &left), 1e-13);
  s.scene.background = {1, 0, 0};
  EXPECT_NEAR(sampled(s, 1).x, composited({{0.5, 1}, {1.5, 1}, {2.5, 1}}) + left, 1e-13);
  s.scene.background = {};
  // A cut takes of the length, not of the place.
  s.clipBefore(1.2);
  EXPECT_NEAR(sampled(s, 1).x, composited({{1.5, 0.8}, {2.5, 1}}), 1e-13);
  // Steps of 0.8 begin at y = -10 + 0.8 k: -0.4, 0.4, 1.2, 2, 2.8. The last one's middle is held at the box.
  s.scene.clip.clear();
  EXPECT_NEAR(sampled(s, 0.8).x, composited({{0, 0.4}, {0.8, 0.8}, {1.6, 0.8}, {2.4, 0.8}, {3, 0.2}}), 1e-13);
}

TEST(VolumeLattice, ToolsSplitAStep) {
  VolumeScene s = sampledScene();
  s.sheet(1.2, 0.25, kRed);
  double front = 1;
  const double before = composited({{0.5, 1}, {1.5, 0.2}}, &front);
  EXPECT_NEAR(sampled(s, 1).x, before + front * (0.25 + 0.75 * composited({{1.5, 0.8}, {2.5, 1}})), 1e-13);
  s.sheet(1.6, 1, kRed);
  double between = 1;
  const double behind = composited({{1.5, 0.4}}, &between);
  EXPECT_NEAR(sampled(s, 1).x, before + front * (0.25 + 0.75 * (behind + between)), 1e-13);
  // In front of and behind the volume.
  VolumeScene apart = sampledScene();
  apart.sheet(-3, 0.25, kRed);
  apart.sheet(5, 0.5, kRed);
  double left = 1;
  const double volume = composited({{0.5, 1}, {1.5, 1}, {2.5, 1}}, &left);
  EXPECT_NEAR(sampled(apart, 1).x, 0.25 + 0.75 * (volume + 0.5 * left), 1e-13);
}

// Halving the step divides the error by four; with opacities times lengths it does not go away.
TEST(VolumeLattice, TendsToTheTruth) {
  for (const ShadingModel shading : {ShadingModel::None, ShadingModel::ColourPerVoxel}) {
    VolumeScene s = sampledScene();
    s.volume().shading = shading;
    const glm::dvec3 truth(pixelOf(s).rgba);
    const auto error = [&](double step) { return glm::length(sampled(s, step) - truth); };
    for (double step : {0.5, 0.25, 0.125}) EXPECT_NEAR(std::log2(error(step) / error(step / 2)), 2, 0.1);
    EXPECT_LT(error(1 / 1024.0), 1e-6);
  }
  VolumeScene linear = sampledScene();
  linear.volume().transfer->opacities = {{0, 0.5}};
  const glm::dvec3 truth(pixelOf(linear).rgba);
  EXPECT_LT(glm::length(sampled(linear, 0.01) - truth), 1e-4);
  linear.volume().opacity = OpacityRule::Linear;
  EXPECT_EQ(glm::dvec3(pixelOf(linear).rgba), truth);  // the truth knows no linear rule
  const double a = 0.5 * 0.5;                          // half a mm
  EXPECT_NEAR(sampled(linear, 0.5).y, 0.5 * (1 - std::pow(1 - a, 6)), 1e-13);
  EXPECT_GT(glm::length(sampled(linear, 0.01) - truth), 1e-3);
  linear.clipBefore(0.2);  // 0.3 of the first step are left
  EXPECT_NEAR(sampled(linear, 0.5).y, 0.5 * (1 - std::pow(1 - a, 5.6)), 1e-13);
}

TEST(VolumeLattice, NoDataAndColours) {
  VolumeInfo info;
  info.grid = gridOf(2, 4, 2);
  info.noData = NoDataRange{-5, -5};
  VolumeScene s = sampledScene();
  s.sources.volumes["v"] =
      floatVolume(info, [](auto, auto j, auto) { return j == 1 || j == 2 ? -5.0 : static_cast<double>(j); });
  EXPECT_NEAR(sampled(s, 1).x, composited({{0, 1}, {3, 1}}), 1e-13);  // at 0.5, 1.5 (none), 2.5
  std::vector<std::byte> bytes;
  for (int n = 0; n < 16; ++n)
    for (int c : {51 * (n / 2 % 4), 51, 255, 102}) bytes.push_back(static_cast<std::byte>(c));
  VolumeInfo colour;
  colour.grid = gridOf(2, 4, 2);
  s.sources.volumes["v"] = *Volume::makeColour(colour, 4, bytes);
  s.volume().gains = {2, 1, 1, 1};
  const double k = 0.6;  // left of 0.4
  const glm::dvec3 got = sampled(s, 1);
  EXPECT_NEAR(got.x, 0.4 * (0.2 + k * 0.6 + k * k * 1), 1e-13);
  EXPECT_NEAR(got.y, 0.2 * (1 - k * k * k), 1e-13);
}

}  // namespace
}  // namespace vernier::quality
