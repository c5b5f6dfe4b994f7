// SPDX-License-Identifier: GPL-3.0-or-later
// dvr.native and iso.native against the reference in double, through the planner.
#include "NativeCases.h"

namespace vernier::test {
namespace {

void cut(NativeCase& c) {
  c.scene.crop = CropBox{VoxelPoint(2, 3, 1.5), VoxelPoint(18, 17, 12)};
  c.scene.clip = {{PatientVec(0.6, 0.8, 0),
                   glm::dot(glm::dvec3(0.6, 0.8, 0), c.sources.volumes["v"]->grid().centre().p) + 2}};
}

void light(NativeCase& c) {
  c.scene.lights = {Light{PatientVec(1, -1, 2), {1, .9, .8}}, Light{std::nullopt, {.2, .3, .4}}};
}

// Where a normal turns from one side to the other, a light beside the eye jumps: there the order is the
// first.
TEST(NativePictures, BlendComesCloserWithTheStep) {
  for (const ShadingModel model :
       {ShadingModel::None, ShadingModel::GlobalAmbient, ShadingModel::ColourPerVoxel})
    for (const Projection p : {Projection::Orthographic, Projection::Perspective}) {
      NativeCase c(volumeLayer(vesselFunction()));
      c.scene.camera.projection = p;
      c.volume().shading = model;
      cut(c), light(c);
      double before = c.error(1).rms;
      for (const double step : {0.5, 0.25, 0.125}) {
        const double rms = c.error(step).rms;
        EXPECT_LT(rms, (model == ShadingModel::None ? 0.4 : 0.6) * before + 0.01)
            << int(model) << int(p) << " step " << step;
        before = rms;
      }
      EXPECT_LT(c.error(0.125).p99, model == ShadingModel::None ? 0.3 : 1.2) << int(model) << int(p);
    }
}

TEST(NativePictures, IsosurfacesAreTheReference) {
  for (const Projection p : {Projection::Orthographic, Projection::Perspective})
    for (const bool whole : {true, false}) {
      NativeCase c(isoLayer(90));
      c.scene.camera.projection = p;
      light(c);
      if (!whole) cut(c);
      const quality::ErrorReport e = c.error();
      EXPECT_GT(e.population, 500u);
      EXPECT_LT(e.max, 0.02) << int(p) << whole;
    }
}

TEST(NativePictures, ExtremesAreTheReference) {
  for (const VolumeMode mode : {VolumeMode::Max, VolumeMode::Min}) {
    NativeCase c(volumeLayer(vesselFunction()));
    c.volume().mode = mode;
    cut(c);
    EXPECT_LT(c.error().max, 0.02) << int(mode);
  }
}

TEST(NativePictures, ToolsStandInThePicture) {
  for (const double opacity : {1.0, 0.5}) {
    NativeCase blend(volumeLayer(vesselFunction())), iso(isoLayer(90)), most(volumeLayer(vesselFunction()));
    most.volume().mode = VolumeMode::Max;
    for (NativeCase* c : {&blend, &iso, &most}) c->addTools(opacity);
    // Distances of tools are floats.
    EXPECT_LT(blend.error(0.125).p99, 0.5) << opacity;
    EXPECT_LT(iso.error().p99, 0.05) << opacity;
    EXPECT_LT(most.error().p99, 0.05) << opacity;
  }
}

TEST(NativePictures, TheClassificationIsChosenByTheStep) {
  NativeCase soft(volumeLayer(vesselFunction()));
  EXPECT_NE(soft.dump().find(", post"), std::string::npos) << soft.dump();
  const TransferFunction narrow{{{0, {1, .8, .6}}}, {{88, 0}, {90, .9}, {92, 0}}, 1};
  NativeCase peak(volumeLayer(narrow));
  EXPECT_NE(peak.dump().find(", pre-integrated"), std::string::npos) << peak.dump();
  const double chosen = peak.error(1).rms;
  peak.volume().classification = Classification::Post;
  EXPECT_NE(peak.dump().find(", post"), std::string::npos);
  EXPECT_LT(chosen, 0.6 * peak.error(1).rms);
}

TEST(NativePictures, AStepFunctionIsRightButForItsEdges) {
  const TransferFunction f{
      {{0, {.2, .4, .9}}, {90, {.2, .4, .9}}, {90, {1, .9, .7}}}, {{60, 0}, {60, .1}, {90, .1}, {90, 1}}, 1};
  NativeCase c(volumeLayer(f));
  EXPECT_NE(c.dump().find(", pre-integrated"), std::string::npos) << c.dump();
  double before = c.error(1).rms;
  for (const double step : {0.25, 0.0625}) {
    const double rms = c.error(step).rms;
    EXPECT_LT(rms, before) << step;
    before = rms;
  }
}

TEST(NativePictures, WhatCannotBeIsRefusedWithASentence) {
  const auto says = [](const NativeCase& c, const std::string& what) {
    const std::string all = c.refusal();
    EXPECT_NE(all.find(what), std::string::npos) << "\"" << all << "\" for " << what;
  };
  NativeCase c(volumeLayer(vesselFunction()));
  c.volume().combiner = "diffuse";
  says(c, "combiner");
  c.volume().combiner.clear(), c.volume().transfer.reset(), c.volume().preset = "glow";
  says(c, "No transfer function is called 'glow'; there are ct,");
  c.volume().preset = "mr";
  EXPECT_EQ(c.refusal(), "");
  c.volume().classification = Classification::PreIntegrated, c.volume().opacity = OpacityRule::Linear;
  says(c, "Pre-integrated tables hold exact opacities");
  c.volume().classification.reset();
  EXPECT_EQ(c.refusal(), "");
  c.volume().shading = ShadingModel::ColourPerVoxel, c.volume().material.power = NAN;
  says(c, "The power lies between 0 and 1000");
  c.volume().material = {};
  c.scene.lights.resize(1);
  c.scene.lights[0].towards = PatientVec(0, 0, 0);
  says(c, "A light needs a direction");
  c.scene.lights.clear();
  c.volume().mode = VolumeMode::Max;
  says(c, "no face that could be lit");
  TransferFunction bad = vesselFunction();
  bad.opacities[1].value = NAN;
  says(NativeCase(volumeLayer(bad)), "finite number");
  for (const std::array<std::int64_t, 3> n : {std::array<std::int64_t, 3>{8, 8, 1}, {1, 1, 1}, {1, 8, 8}}) {
    VolumeInfo info;
    info.grid = unitGrid(n[0], n[1], n[2]);
    const auto flat = volumeOf(info, std::vector<std::int16_t>(std::size_t(n[0] * n[1] * n[2]), 5));
    EXPECT_NE(NativeCase(volumeLayer(vesselFunction()), flat).refusal(), "");
    EXPECT_NE(NativeCase(isoLayer(3), flat).refusal(), "");
  }
}

TEST(NativePictures, TenThousandPoints) {
  TransferFunction f{{{0, {1, 1, 1}}}, {}, 1};
  for (int n = 0; n < 10000; ++n)
    f.opacities.push_back({n * 0.015, n > 4000 ? 0.3 + 0.1 * std::sin(n * 0.01) : 0});
  const NativeCase c(volumeLayer(f));
  EXPECT_LT(c.error(0.125).rms, 1);
}

TEST(NativePictures, OneFunctionIsMadeOnce) {
  const NativeCase c(volumeLayer(vesselFunction()));
  const Frame first = c.draw(), second = c.draw();
  EXPECT_EQ(first.images.colour, second.images.colour);
  EXPECT_EQ(first.images.counters.samples, second.images.counters.samples);
  EXPECT_GT(first.images.counters.samples, 1000u);
}

}  // namespace
}  // namespace vernier::test
