// SPDX-License-Identifier: GPL-3.0-or-later
// projection.gl against projection.native on the same lattice: within half a level at 999 of 1000 pixels.
#include <gmock/gmock.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "AngiographyTechniques.h"
#include "ProjectionCases.h"
#include "TestPaths.h"

namespace vernier::test {
namespace {

using ::testing::HasSubstr;

template <class T>
std::shared_ptr<const Volume> noise(double low, double high, ModalityRescale rescale) {
  VolumeInfo info = vesselVolume(true)->info();
  info.rescale = {rescale};
  return volumeOf(info, randomValues<T>(22 * 20 * 15, 7, low, high));
}

// Padding here and there, and a corner that is all of it.
std::shared_ptr<const Volume> padded() {
  VolumeInfo info = vesselVolume()->info();
  info.noData = NoDataRange{0, 250};
  std::vector<std::int16_t> values = randomValues<std::int16_t>(22 * 20 * 15, 7, 0, 1000);
  for (std::size_t k = 0; k < 9; ++k)
    for (std::size_t j = 0; j < 12; ++j) std::fill_n(values.begin() + 22 * (j + 20 * k), 13, 100);
  return volumeOf(info, values);
}

struct Phantom {
  const char* name;
  std::shared_ptr<const Volume> volume;
  VoiWindow window;
};
std::vector<Phantom> phantoms() {
  const auto ramp = [](double center, double width) {
    return VoiWindow{center, width, VoiFunction::LinearExact, ""};
  };
  return {{"vessels", vesselVolume(), ramp(90, 120)},
          {"signed", noise<std::int16_t>(-1000, 1500, {1, -24}), ramp(300, 1500)},
          {"unsigned, falling", noise<std::uint16_t>(0, 4000, {-0.5, 900}), ramp(0, 1200)},
          {"bytes", noise<std::uint8_t>(0, 255, {2, -10}), {200, 300, VoiFunction::Sigmoid, ""}},
          {"padded", padded(), ramp(500, 900)},
          {"wide", noise<std::int32_t>(100'000, 900'000, {0.01, 0}), ramp(5000, 6000)}};
}

struct Variant {
  const char* name;
  std::function<void(LookCase&)> change;
};
const std::vector<Variant>& variants() {
  static const std::vector<Variant> all{
      {"plain", [](LookCase&) {}},
      {"cut",
       [](LookCase& c) {
         c.scene.crop = CropBox{VoxelPoint(2, 3, 1.5), VoxelPoint(18, 17, 12)};
         const glm::dvec3 n(0.6, 0.8, 0), middle = c.sources.volumes["v"]->grid().centre().p;
         c.scene.clip = {{PatientVec(n), glm::dot(n, middle) + 2}};
       }},
      {"opaque tools", [](LookCase& c) { c.addTools(1); }},
      {"translucent tools, cut",
       [](LookCase& c) {
         c.addTools(0.5);
         c.scene.crop = CropBox{VoxelPoint(1, 1, 1), VoxelPoint(19, 18, 13)};
       }},
      {"inverted, background, tools",
       [](LookCase& c) {
         c.layer().invert = true;
         c.scene.background = {0.1, 0.2, 0.3};
         c.scene.camera.zoom = 0.7;
         c.addTools(0.5);
       }},
      {"an eye inside", [](LookCase& c) {
         if (c.scene.camera.projection == Projection::Perspective)
           c.scene.camera.distance_mm = 2, c.scene.camera.fov_deg = 75;
         else
           c.scene.camera.near_mm = 30;
       }}};
  return all;
}

// Pixels whose colour differs by more than half a level; depths that are not the same.
void expectAgreement(const LookCase& c, const std::string& what, double step = 0.8) {
  const Frame gl = c.draw("projection.gl", step), native = c.draw("projection.native", step);
  ASSERT_EQ(gl.images.colour.size(), native.images.colour.size()) << what;
  const std::size_t pixels = native.images.depth.size();
  std::size_t wrong = 0, farOff = 0, shown = 0;
  for (std::size_t n = 0; n < pixels; ++n) {
    bool differs = false;
    for (std::size_t i = 4 * n; i < 4 * n + 3; ++i)
      differs = differs || !(std::abs(gl.images.colour[i] - native.images.colour[i]) <= 0.5f / 255);
    wrong += differs;
    shown += native.images.depth[n] < kNothing_mm;
    const bool same = gl.images.depth[n] == native.images.depth[n] || native.images.colour[4 * n] == 0;
    farOff += !same && !(std::abs(gl.images.depth[n] - native.images.depth[n]) < 0.01f);
  }
  EXPECT_LE(wrong, pixels / 1000) << what;
  EXPECT_GT(shown, pixels / 8) << what;
  // Where two samples of a ray are nearly alike, either may be the one; where all is black, any.
  EXPECT_LE(farOff, pixels / 50) << what;
}

TEST(ProjectionGl, AgreesWithTheNativeRaysOnTheSameLattice) {
  VERNIER_NEEDS_GL(device);
  for (const Phantom& phantom : phantoms())
    for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
      for (const Variant& variant : variants())
        for (const ProjectionMode mode : kAllModes) {
          LookCase c(phantom.volume);
          c.layer().window = phantom.window;
          c.layer().mode = mode;
          c.scene.camera.projection = projection;
          variant.change(c);
          expectAgreement(c, std::string(phantom.name) + ", " + variant.name + ", mode " +
                                 std::to_string(static_cast<int>(mode)) + ", projection " +
                                 std::to_string(static_cast<int>(projection)));
        }
}

TEST(ProjectionGl, ADepthCueAndNearestNeighboursAgreeToo) {
  VERNIER_NEEDS_GL(device);
  for (const Phantom& phantom : phantoms())
    for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
      LookCase cued(phantom.volume);
      cued.layer().window = phantom.window;
      cued.layer().cue = 0.7;
      cued.scene.camera.projection = projection;
      expectAgreement(cued, std::string(phantom.name) + ", cued");
      cued.addTools(0.5);
      expectAgreement(cued, std::string(phantom.name) + ", cued, tools");
      LookCase nearest(phantom.volume);
      nearest.layer().window = phantom.window;
      nearest.layer().interpolation = Interpolation::Nearest;
      nearest.scene.camera.projection = projection;
      expectAgreement(nearest, std::string(phantom.name) + ", nearest");
    }
}

// The reference, not only the neighbour.
TEST(ProjectionGl, ComesCloserToTheReferenceWithTheStep) {
  VERNIER_NEEDS_GL(device);
  for (const ProjectionMode mode : kAllModes) {
    LookCase c;
    c.layer().mode = mode;
    const double coarse = c.error("projection.gl", 1).rms, fine = c.error("projection.gl", 0.125).rms;
    EXPECT_LT(fine, 0.3 * coarse + 0.01) << static_cast<int>(mode);
    EXPECT_LT(fine, 0.6) << static_cast<int>(mode);
  }
}

TEST(ProjectionGl, TheValueUnderAPixelIsTheNativeOne) {
  VERNIER_NEEDS_GL(device);
  for (const Phantom& phantom : phantoms())
    for (const ProjectionMode mode : kAllModes) {
      LookCase c(phantom.volume);
      c.view.wantValues = true;
      c.layer().window = phantom.window;
      c.layer().mode = mode;
      const std::vector<float> gl = c.draw("projection.gl").images.values,
                               native = c.draw("projection.native").images.values;
      ASSERT_EQ(gl.size(), native.size());
      const auto range = *phantom.volume->modalityRange();
      const bool integral = mode == ProjectionMode::Sum || mode == ProjectionMode::Attenuation;
      const double tolerance = integral ? 1e-3 : 1e-4 * (range.max - range.min);
      std::size_t wrong = 0, some = 0;
      for (std::size_t n = 0; n < gl.size(); ++n) {
        some += !std::isnan(native[n]);
        wrong += std::isnan(gl[n]) != std::isnan(native[n]) ||
                 !(std::isnan(gl[n]) || std::abs(gl[n] - native[n]) <= tolerance);
      }
      EXPECT_GT(some, gl.size() / 8);
      EXPECT_LE(wrong, gl.size() / 1000) << phantom.name << " " << static_cast<int>(mode);
    }
}

TEST(ProjectionGl, TheVolumeIsUploadedOnceAndRaysWithEachPicture) {
  VERNIER_NEEDS_GL(device);
  LookCase c(noise<std::int16_t>(0, 1000, {1, 0}));  // of its own: nobody has uploaded it
  const std::uint64_t rays = 16ull * 72 * 60, volume = 2ull * 22 * 20 * 15;
  const auto uploaded = [&] { return c.draw("projection.gl").images.counters; };
  const Counters first = uploaded(), second = uploaded();
  EXPECT_EQ(first.textures3dCreated, 1u);
  EXPECT_EQ(second.textures3dCreated, 0u);
  EXPECT_EQ(first.bytesUploaded - second.bytesUploaded, volume);
  EXPECT_GE(second.bytesUploaded, rays);
  EXPECT_LT(second.bytesUploaded, rays + 1000);
  EXPECT_GT(second.samples, 10'000u);
  // Translucent tools part rays: another picture of rays for each.
  c.addTools(0.5);
  EXPECT_GE(uploaded().bytesUploaded, 3 * rays);
}

TEST(ProjectionGl, ACancelEndsItBetweenBatches) {
  VERNIER_NEEDS_GL(device);
  LookCase c;
  const Result<Plan> plan = c.plan("projection.gl", 1.0 / 32);
  ASSERT_TRUE(plan.ok());
  std::stop_source stop;
  stop.request_stop();
  Images images;
  const auto done =
      LookHost::instance().registry.find("projection.gl")->execute(plan->passes[0], images, stop.get_token());
  ASSERT_FALSE(done.ok());
  EXPECT_EQ(done.error().code, ErrorCode::Cancelled);
}

class ProjectionGlPlan : public ::testing::Test {
 protected:
  ProjectionGlPlan() { machine.gl = true, machine.max3dTexture = 256, machine.maxTexture = 1024; }
  Result<std::vector<Pass>> ask(const LookCase& c) const {
    return angiography::glProjectionTechnique(LookHost::instance())
        .passesFor(c.scene.layers[0], 0, {c.scene, c.view, quality, machine, costs, c.sources});
  }
  std::string refusal(const LookCase& c) const {
    const auto r = ask(c);
    EXPECT_FALSE(r.ok());
    return r.ok() ? "" : r.error().sentence;
  }
  Capabilities machine;
  Quality quality;
  CostTable costs;
};

TEST_F(ProjectionGlPlan, SaysWhatItTakes) {
  LookCase c;
  const auto passes = ask(c);
  ASSERT_TRUE(passes.ok()) << passes.error().text();
  ASSERT_EQ(passes->size(), 1u);
  const Pass& pass = passes->front();
  EXPECT_EQ(pass.inputs[0], "volume texture");
  ASSERT_EQ(pass.resources.size(), 2u);
  EXPECT_EQ(pass.resources[0].bytes, 4u * 22 * 20 * 15);
  EXPECT_EQ(pass.resources[1].bytes, 32u * 72 * 60);
  EXPECT_EQ(pass.params->dump(), "max, orthographic, step 0.8 mm, window 90,120");
  // It samples the lattice of projection.native, so the same is missed between two samples.
  const Result<Plan> native = c.plan("projection.native");
  ASSERT_TRUE(native.ok());
  EXPECT_EQ(pass.predictedError, native->passes[0].predictedError);
}

TEST_F(ProjectionGlPlan, PlanGolden) {
  LookCase c;
  c.scene.camera.projection = Projection::Perspective;
  c.scene.crop = CropBox{VoxelPoint(4, 3, 2), VoxelPoint(16, 15, 9)};
  c.layer().cue = 0.5;
  c.addTools(0.5);
  quality.technique = "projection.gl";
  quality.step = 0.5;
  const auto plan =
      makePlan(c.scene, c.view, quality, machine, costs, c.sources, LookHost::instance().registry);
  ASSERT_TRUE(plan.ok()) << plan.error().text();
  const std::string path = std::string(VERNIER_SOURCE_DIR) + "/tests/plan/projection-gl-asked.plan.txt";
  std::ifstream in(path);
  std::stringstream golden;
  golden << in.rdbuf();
  EXPECT_EQ(dumpPlan(*plan), golden.str()) << "golden: " << path;
}

TEST_F(ProjectionGlPlan, WithoutACardTheNativeRaysAreTaken) {
  LookCase c;
  machine.glIsSoftware = true, machine.threads = 2;
  Quality draft;
  draft.level = QualityLevel::Draft;
  const Result<Plan> plan =
      makePlan(c.scene, c.view, draft, machine, costs, c.sources, LookHost::instance().registry);
  ASSERT_TRUE(plan.ok());
  EXPECT_EQ(plan->passes[0].technique, "projection.native");
}

TEST_F(ProjectionGlPlan, WhatGlCannotHoldIsRefusedInOneSentence) {
  VolumeInfo uneven;
  uneven.grid = everyGrid()[4].grid;
  EXPECT_THAT(refusal(LookCase(volumeOf(uneven, randomValues<std::int16_t>(7 * 6 * 9, 1, 0, 100)))),
              HasSubstr("unevenly spaced"));
  VolumeInfo longOne;
  longOne.grid = unitGrid(300, 2, 2);
  EXPECT_THAT(refusal(LookCase(volumeOf(longOne, randomValues<std::int16_t>(1200, 1, 0, 100)))),
              HasSubstr("300 voxels on a side; 3-D textures here take up to 256"));
  LookCase c;
  c.view.width_px = 2000;
  EXPECT_THAT(refusal(c), HasSubstr("2000 pixels on a side; GL here draws up to 1024"));
  c.view = {1000, 1000};
  machine.glTextureBudget_bytes = 20 << 20;
  EXPECT_THAT(refusal(c), HasSubstr("rays 30 MB as textures, and GL may hold 20 MB"));
  c.layer().window = VoiWindow{0, -1, VoiFunction::Linear, ""};
  EXPECT_EQ(ask(c).error().where, "/layers/0/window");
}

}  // namespace
}  // namespace vernier::test
