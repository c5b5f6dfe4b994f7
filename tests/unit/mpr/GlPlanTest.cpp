// SPDX-License-Identifier: GPL-3.0-or-later
// What the GL techniques accept, refuse and promise.
#include <gmock/gmock.h>

#include "GlCases.h"

namespace vernier::mpr {
namespace {
using namespace vernier::mpr::test;
using testing::HasSubstr;
using vernier::test::everyGrid;
using vernier::test::unitGrid;

class GlPlan : public testing::Test {
 protected:
  GlPlan() {
    machine.gl = true, machine.max3dTexture = 256, machine.maxTexture = 1024;
    view.width_px = 100, view.height_px = 80;
  }
  Result<std::vector<Pass>> ask(const Technique& t, std::shared_ptr<const Volume> volume) {
    SliceLayer slice;
    slice.source = "v";
    slice.plane = {volume->grid().centre(), PatientVec(1, 2, -3), PatientVec(0, -1, 0)};
    slice.slab = slab;
    slice.interpolation = interpolation;
    slice.window = VoiWindow{40, 400, VoiFunction::Linear, ""};
    Scene scene;
    scene.layers = {slice};
    Sources sources;
    sources.volumes["v"] = std::move(volume);
    return t.passesFor(scene.layers[0], 0, {scene, view, quality, machine, costs, sources});
  }
  GlHost host{nullptr};
  Technique strips = stripsTechnique(host), polygon = polygonTechnique(host);
  Capabilities machine;
  View view;
  Quality quality;
  CostTable costs;
  Slab slab;
  Interpolation interpolation = Interpolation::Linear;
};

TEST_F(GlPlan, OnePassWithItsTextures) {
  const auto volume = noiseVolume<std::int16_t>(unitGrid(20, 20, 10), 0, 100);
  const auto s = ask(strips, volume);
  ASSERT_TRUE(s.ok()) << s.error().text();
  ASSERT_EQ(s->size(), 1u);
  EXPECT_THAT(s->front().resources.at(0).name, HasSubstr("texture2d x"));
  EXPECT_LE(s->front().resources.at(0).bytes, 20u * 20 * 10 * 2);
  EXPECT_GT(s->front().resources.at(0).bytes, 0u);
  EXPECT_GT(s->front().predicted_ms, 0);
  EXPECT_FALSE(s->front().fixedFunctionFiltering);
  const auto p = ask(polygon, volume);
  ASSERT_TRUE(p.ok()) << p.error().text();
  EXPECT_EQ(p->front().resources.at(0).name, "texture3d");
  EXPECT_EQ(p->front().resources.at(0).bytes, 20u * 20 * 10 * 2);
}

TEST_F(GlPlan, FixedFunctionFilteringIsForDraftsOfPlainVolumesOnly) {
  const auto plain = noiseVolume<std::int16_t>(unitGrid(20, 20, 10), 0, 100);
  const auto padded = noiseVolume<std::int16_t>(unitGrid(20, 20, 10), 0, 100, {}, NoDataRange{0, 1});
  const auto floats = noiseVolume<float>(unitGrid(20, 20, 10), 0, 100);
  for (const Technique* t : {&strips, &polygon}) {
    for (const QualityLevel level : {QualityLevel::Review, QualityLevel::Reference}) {
      quality.level = level;
      EXPECT_FALSE(ask(*t, plain)->front().fixedFunctionFiltering);
    }
    const double exact = ask(*t, plain)->front().predictedError;
    quality.level = QualityLevel::Draft;
    EXPECT_TRUE(ask(*t, plain)->front().fixedFunctionFiltering);
    EXPECT_GT(ask(*t, plain)->front().predictedError, exact);
    EXPECT_FALSE(ask(*t, padded)->front().fixedFunctionFiltering);
    EXPECT_FALSE(ask(*t, floats)->front().fixedFunctionFiltering);
    interpolation = Interpolation::Nearest;
    EXPECT_FALSE(ask(*t, plain)->front().fixedFunctionFiltering);
    interpolation = Interpolation::Linear;
  }
  EXPECT_FALSE(
      ask(strips, noiseVolume<std::int16_t>(everyGrid()[4].grid, 0, 100))->front().fixedFunctionFiltering);
}

TEST_F(GlPlan, PolygonRefusesWhatA3dTextureCannotHold) {
  const auto refused = [&](std::shared_ptr<const Volume> v) {
    const auto r = ask(polygon, std::move(v));
    EXPECT_FALSE(r.ok());
    return r.ok() ? std::string() : r.error().sentence;
  };
  EXPECT_THAT(refused(noiseVolume<std::int16_t>(everyGrid()[4].grid, 0, 100)), HasSubstr("unevenly"));
  EXPECT_THAT(refused(noiseVolume<std::int16_t>(everyGrid()[5].grid, 0, 100)), HasSubstr("gaps"));
  EXPECT_THAT(refused(noiseVolume<std::int16_t>(unitGrid(300, 2, 2), 0, 100)), HasSubstr("up to 256"));
  machine.glTextureBudget_bytes = 2 << 20;
  EXPECT_THAT(refused(noiseVolume<std::int16_t>(unitGrid(200, 200, 50), 0, 100)), HasSubstr("2 MB"));
  EXPECT_TRUE(ask(strips, noiseVolume<std::int16_t>(unitGrid(300, 200, 5), 0, 100)).ok());
  slab = {4000, SlabMode::Max}, quality.step = 0.5;
  EXPECT_THAT(refused(noiseVolume<std::int16_t>(unitGrid(20, 20, 10), 0, 100)), HasSubstr("4096"));
}

TEST_F(GlPlan, BothRefuseWhatFloatsCannotHold) {
  for (const Technique* t : {&strips, &polygon}) {
    const auto wide = ask(*t, noiseVolume<std::int32_t>(unitGrid(8, 8, 8), -2e9, 2e9));
    ASSERT_FALSE(wide.ok());
    EXPECT_THAT(wide.error().sentence, HasSubstr("2^24"));
    EXPECT_FALSE(ask(*t, noiseVolume<float>(unitGrid(8, 8, 8), -3e38, 3e38)).ok());
    view.width_px = 2000;
    EXPECT_THAT(ask(*t, noiseVolume<float>(unitGrid(8, 8, 8), 0, 1)).error().sentence, HasSubstr("2000"));
    view.width_px = 100;
  }
  EXPECT_THAT(ask(strips, noiseVolume<std::uint8_t>(unitGrid(1100, 2, 2), 0, 9)).error().sentence,
              HasSubstr("1024"));
}

TEST_F(GlPlan, MeasuredCostsWinOverBuiltInOnes) {
  const auto volume = noiseVolume<std::int16_t>(unitGrid(20, 20, 10), 0, 100);
  const double builtIn = ask(strips, volume)->front().predicted_ms;
  costs.nsPerSample["mpr.strips"] = 1e5;
  EXPECT_GT(ask(strips, volume)->front().predicted_ms, 10 * builtIn);
}

}  // namespace
}  // namespace vernier::mpr
