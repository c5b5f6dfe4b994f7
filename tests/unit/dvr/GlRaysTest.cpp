// SPDX-License-Identifier: GPL-3.0-or-later
// dvr.rays against a double evaluation of the same lattice.
#include <gmock/gmock.h>

#include "GlCases.h"

namespace vernier::test {
namespace {

using ::testing::HasSubstr;

void expectRays(const DvrCase& c, double share = 0.001) {
  const DvrTruth truth(c);
  expectClose(
      c, "dvr.rays", [&](double x, double y) { return truth.rays(x, y); }, share);
}

TEST(GlRays, BlendOnTheLatticeInBothProjections) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections)
    for (const double step : {1.0, 0.3}) {
      DvrCase c;
      c.scene.camera.projection = projection, c.quality.step = step;
      expectRays(c);
    }
}

TEST(GlRays, EveryWayOfReadingAndClassifying) {
  VERNIER_NEEDS_GL(device);
  for (int way = 0; way < 6; ++way) {
    SCOPED_TRACE(way);
    DvrCase c(way == 4 ? bumpyVolume(tiltedGrid(30, 28, 22), NoDataRange{500, 2000}) : bumpyVolume());
    if (way == 0) c.layer().interpolation = Interpolation::Nearest;
    if (way == 1) c.layer().classification = Classification::Pre;
    if (way == 2) c.layer().opacity = OpacityRule::Linear;
    if (way == 3) c = DvrCase(bumpyVolume(tiltedGrid(30, 28, 22, {0.8, 0.9, 1.2}, true)));
    if (way == 5) c.layer().transfer->opacities = {{0, 0}, {150, 1}};  // without end
    expectRays(c, way == 0 ? 0.02 : 0.001);  // nearest: rounding decides at faces of voxels
  }
}

TEST(GlRays, PreIntegratedSteps) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections) {
    DvrCase c;
    c.scene.camera.projection = projection, c.view = {40, 36};
    c.layer().classification = Classification::PreIntegrated;
    c.layer().transfer->opacities = {{40, 0}, {60, .5}, {80, .1}, {300, .9}};  // a peak that steps pass over
    c.scene.crop = CropBox{VoxelPoint(3.2, 2.7, 1.1), VoxelPoint(26.4, 25.1, 19.6)};
    expectRays(c);
  }
}

std::shared_ptr<const Volume> asFloats(const Volume& source) {
  VolumeInfo info;
  info.grid = source.grid();
  std::vector<float> values;
  for (std::int64_t k = 0; k < 22; ++k)
    for (std::int64_t j = 0; j < 28; ++j)
      for (std::int64_t i = 0; i < 30; ++i) values.push_back(static_cast<float>(source.modality(i, j, k)));
  values[5000] = std::numeric_limits<float>::quiet_NaN();
  return volumeOf(info, values);
}

TEST(GlRays, FloatVoxels) {
  VERNIER_NEEDS_GL(device);
  expectRays(DvrCase(asFloats(*bumpyVolume())));
}

// Where voxels may have no data, samples of the lattice are looked at and what lies between two is halved.
TEST(GlRays, SurfacesAndExtremesOnTheLattice) {
  VERNIER_NEEDS_GL(device);
  DvrCase iso(asFloats(*bumpyVolume()), true);
  iso.quality.step = 0.2, iso.scene.camera.zoom = 1.6;
  const DvrTruth surface(iso);
  // Rims thinner than a step are passed over.
  expectClose(
      iso, "dvr.rays", [&](double x, double y) { return surface.isosurface(x, y); }, 0.003);
  EXPECT_EQ(iso.draw("dvr.rays")->counters.cells, 0u);
  DvrCase max(asFloats(*bumpyVolume()));
  max.layer().mode = VolumeMode::Max, max.quality.step = 0.05;
  const DvrTruth extreme(max);
  expectClose(
      max, "dvr.rays", [&](double x, double y) { return extreme.extreme(x, y); }, 0.01);
  DvrCase cells(bumpyVolume(), true);
  EXPECT_GT(cells.draw("dvr.rays")->counters.cells, 10000u);
}

TEST(GlRays, CropClipPlanesAndNearDistanceSplitTheirSteps) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections) {
    DvrCase c;
    c.scene.camera.projection = projection;
    c.scene.crop = CropBox{VoxelPoint(3.2, 2.7, 1.1), VoxelPoint(26.4, 25.1, 19.6)};
    const PatientPoint middle = c.volume().grid().centre();
    const PatientVec n = normalize(PatientVec(1, 2, -0.5));
    c.scene.clip = {{n, dot(n, PatientVec(middle.p)) + 2.3}};
    c.scene.camera.near_mm = projection == Projection::Perspective ? 45 : 22;
    expectRays(c);
  }
}

TEST(GlRays, ToolsEndRaysOrCoverWhatIsBehind) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections) {
    DvrCase c;
    c.scene.camera.projection = projection;
    c.addTool(1.5, 8, 1);
    expectRays(c);
    c.addTool(-4, 10, 0.4, {0.9, 0.1, 0.9});
    c.addTool(-2, 6, 0.3, {0.1, 0.6, 0.9});
    expectRays(c);
    c = DvrCase(bumpyVolume(), true);
    c.scene.camera.projection = projection;
    c.addTool(-6, 10, 0.4);
    c.addTool(0, 6, 1, {0.9, 0.1, 0.9});
    const DvrTruth truth(c);
    expectClose(c, "dvr.rays", [&](double x, double y) { return truth.isosurface(x, y); });
  }
}

TEST(GlRays, ExtremesKeepTheirColourAtTheirOpacity) {
  VERNIER_NEEDS_GL(device);
  for (const VolumeMode mode : {VolumeMode::Max, VolumeMode::Min})
    for (const bool colours : {false, true}) {
      DvrCase c(colours ? colourVolume() : bumpyVolume());
      c.layer().mode = mode;
      if (mode == VolumeMode::Min && !colours) c.layer().transfer->opacities = {{-100, 0.3}, {300, 0.9}};
      c.layer().gains = {1.5, 0.7, 1, 0.5};
      c.addTool(3, 6, 1);
      const DvrTruth truth(c);
      expectClose(c, "dvr.rays", [&](double x, double y) { return truth.extreme(x, y); });
    }
}

TEST(GlRays, ColourVolumesWithGains) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections)
    for (const OpacityRule rule : {OpacityRule::Exact, OpacityRule::Linear}) {
      DvrCase c(colourVolume());
      c.scene.camera.projection = projection, c.quality.step = 0.5;
      c.layer().gains = {1.2, 0.8, 2, 1.7}, c.layer().opacity = rule;
      expectRays(c);
    }
}

TEST(GlRays, ShadingByBothModelsAndSeveralLights) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections)
    for (const ShadingModel model : {ShadingModel::GlobalAmbient, ShadingModel::ColourPerVoxel}) {
      DvrCase c(bumpyVolume(tiltedGrid(30, 28, 22), {}, 40));
      c.scene.camera.projection = projection;
      c.layer().shading = model;
      c.layer().material.ambientColour = {0.3, 0.4, 0.9}, c.layer().material.diffuseColour = {0.9, 0.5, 0.2};
      c.scene.lights = {Light{}, Light{PatientVec(1, -2, 3), {0.7, 0.2, 0.1}}};
      expectRays(c);
    }
}

TEST(GlRays, IsoSurfacesAreTheFirstRoot) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections) {
    DvrCase c(bumpyVolume(), true);
    c.scene.camera.projection = projection, c.scene.camera.zoom = 2;
    c.scene.lights = {Light{}, Light{PatientVec(-1, -2, 1), {0.2, 0.3, 0.9}}};
    const PatientPoint middle = c.volume().grid().centre();
    const PatientVec n = normalize(PatientVec(0.3, -2, 0.5));
    c.scene.clip = {{n, dot(n, PatientVec(middle.p)) + 1}};
    const DvrTruth truth(c);
    // The lattice may step over a rim.
    expectClose(
        c, "dvr.rays", [&](double x, double y) { return truth.isosurface(x, y); }, 0.005);
    const Result<Images> images = c.draw("dvr.rays");
    std::size_t hits = 0;
    for (int y = 0; y < images->height; ++y)
      for (int x = 0; x < images->width; ++x) {
        double at = INFINITY;
        truth.isosurface(x + 0.5, y + 0.5, &at);
        const double got = images->depth[static_cast<std::size_t>(x + images->width * y)];
        hits += std::isfinite(at) && std::abs(got - at) < 1e-3;
      }
    EXPECT_GT(hits, 500u);
  }
}

// NUMERICS F1: C = c (1 - exp(-tau L)).
TEST(GlRays, F1_ConstantVolumeIsItsClosedForm) {
  VERNIER_NEEDS_GL(device);
  VolumeInfo info;
  info.grid = tiltedGrid(20, 20, 20);
  for (const double a : {0.002, 0.05, 0.5}) {
    DvrCase c(volumeOf(info, std::vector<std::int16_t>(8000, 7)));
    c.layer().transfer = TransferFunction{{{0, {0.9, 0.5, 0.2}}}, {{0, a}}, 1};
    c.scene.background = {};
    c.quality.step = 0.25;
    const DvrTruth truth(c);
    const Result<Images> images = c.draw("dvr.rays");
    ASSERT_TRUE(images.ok()) << images.error().text();
    const Off off = offFrom(*images, [&](double x, double y) {
      const RaySpan s = truth.span(x, y);
      const double length = s.empty() ? 0 : s.exit_mm - s.entry_mm;
      return glm::dvec3(0.9, 0.5, 0.2) * (1 - std::pow(1 - a, length));
    });
    EXPECT_LT(off.worst, 0.25);
  }
}

TEST(GlRays, DepthIsWhereHalfTheLightIsGone) {
  VERNIER_NEEDS_GL(device);
  VolumeInfo info;
  info.grid = tiltedGrid(20, 20, 20);
  DvrCase c(volumeOf(info, std::vector<std::int16_t>(8000, 7)));
  c.layer().transfer = TransferFunction{{{0, {0.9, 0.5, 0.2}}}, {{0, 0.1}}, 1};
  const DvrTruth truth(c);
  const Result<Images> images = c.draw("dvr.rays");
  const double half = std::log(0.5) / std::log(0.9);
  std::size_t deep = 0;
  for (int y = 0; y < images->height; ++y)
    for (int x = 0; x < images->width; ++x) {
      const RaySpan s = truth.span(x + 0.5, y + 0.5);
      const float got = images->depth[static_cast<std::size_t>(x + images->width * y)];
      const double length = s.empty() ? 0 : s.exit_mm - s.entry_mm;
      if (length < half - c.step_mm()) {
        EXPECT_EQ(got, kNothing_mm);
      }
      if (length < half + c.step_mm()) continue;
      EXPECT_NEAR(got, s.entry_mm + half, c.step_mm());
      ++deep;
    }
  EXPECT_GT(deep, 500u);
}

TEST(GlRays, CountersAreWhatWasDone) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  c.layer().transfer->opacities = {{0, 0.001}};
  const Result<Images> first = c.draw("dvr.rays");
  ASSERT_TRUE(first.ok());
  const DvrTruth truth(c);
  std::uint64_t samples = 0;
  for (int y = 0; y < c.view.height_px; ++y)
    for (int x = 0; x < c.view.width_px; ++x) {
      const RaySpan s = truth.span(x + 0.5, y + 0.5);
      if (!s.empty())
        samples += static_cast<std::uint64_t>(std::ceil(s.exit_mm / c.step_mm()) -
                                              std::floor(s.entry_mm / c.step_mm()));
    }
  EXPECT_EQ(first->counters.samples, samples);
  EXPECT_EQ(first->counters.textures3dCreated, 1u);
  EXPECT_GE(first->counters.bytesUploaded, 30u * 28 * 22 * 2);
  const Result<Images> again = c.draw("dvr.rays");
  EXPECT_EQ(again->colour, first->colour);
  EXPECT_EQ(again->counters.textures3dCreated, 0u);
  EXPECT_EQ(first->counters.bytesUploaded - again->counters.bytesUploaded, 30u * 28 * 22 * 2);
  // Opaque: rays end early.
  c.layer().transfer->opacities = {{-100, 0.999}};
  EXPECT_LT(c.draw("dvr.rays")->counters.samples, samples / 3);
  // Shading costs six reads more, where something is seen.
  c.layer().transfer->opacities = {{0, 0.001}};
  c.layer().shading = ShadingModel::ColourPerVoxel;
  EXPECT_EQ(c.draw("dvr.rays")->counters.samples, 7 * samples);
}

TEST(GlRays, FixedFunctionFilteringIsForDrafts) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  EXPECT_FALSE(c.plan("dvr.rays")->passes[0].fixedFunctionFiltering);
  c.quality.level = QualityLevel::Draft;
  const Result<Plan> plan = c.plan("dvr.rays");
  EXPECT_TRUE(plan->passes[0].fixedFunctionFiltering);
  const DvrTruth truth(c);
  const Off off = offFrom(*c.draw("dvr.rays"), [&](double x, double y) { return truth.rays(x, y); });
  EXPECT_LT(off.worst, 255 * 3.0 / 512 + 0.5);
  c.layer().interpolation = Interpolation::Nearest;
  EXPECT_FALSE(c.plan("dvr.rays")->passes[0].fixedFunctionFiltering);
}

TEST(GlRays, AllStateIsStated) {
  VERNIER_NEEDS_GL(device);
  for (const bool iso : {false, true}) {
    DvrCase c(bumpyVolume(), iso);
    const Result<Images> clean = c.draw("dvr.rays");
    for (const unsigned seed : {1u, 2u}) {
      device->setOddStateForTest(seed);
      EXPECT_EQ(c.draw("dvr.rays")->colour, clean->colour);
    }
  }
}

TEST(GlRays, CancelStopsWithinABatch) {
  VERNIER_NEEDS_GL(device);
  std::stop_source stop;
  stop.request_stop();
  const Result<Images> images = DvrCase().draw("dvr.rays", stop.get_token());
  ASSERT_FALSE(images.ok());
  EXPECT_EQ(images.error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace vernier::test
