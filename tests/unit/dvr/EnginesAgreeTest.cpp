// SPDX-License-Identifier: GPL-3.0-or-later
// Rays on OpenGL and native rays stand on the same lattice: they agree within half a level at 99.9 % of the
// pixels, and everywhere within what one cell of a table or one step at an edge may do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "GlCases.h"

namespace vernier {
namespace {

using namespace vernier::test;

void addNative() {
  static const bool added = [] {
    for (Technique (*make)(Host&) : {dvr::nativeVolumeTechnique, dvr::nativeIsosurfaceTechnique})
      EXPECT_TRUE(DvrHost::instance().addTechnique(make(DvrHost::instance())).ok());
    return true;
  }();
  (void)added;
}

void expectAgreement(const DvrCase& c, const std::string& native) {
  addNative();
  const Result<Images> ours = c.draw(native), gl = c.draw("dvr.rays");
  ASSERT_TRUE(ours) << ours.error().text();
  ASSERT_TRUE(gl) << gl.error().text();
  ASSERT_EQ(ours->colour.size(), gl->colour.size());
  std::size_t far = 0, seen = 0;
  const std::size_t pixels = ours->colour.size() / 4;
  for (std::size_t n = 0; n < pixels; ++n) {
    double worst = 0;
    for (std::size_t k = 0; k < 3; ++k)
      worst = std::max(worst,
                       255.0 * std::abs(static_cast<double>(std::clamp(ours->colour[4 * n + k], 0.f, 1.f)) -
                                        static_cast<double>(std::clamp(gl->colour[4 * n + k], 0.f, 1.f))));
    if (worst > 0.5) ++far;
    if (ours->depth[n] != kNothing_mm) ++seen;
  }
  EXPECT_LE(far, pixels / 1000);
  EXPECT_GT(seen, pixels / 20) << "the picture shows something";
}

class EnginesAgree : public ::testing::TestWithParam<Projection> {
 protected:
  DvrCase of(std::shared_ptr<const Volume> volume = bumpyVolume(), bool iso = false) const {
    DvrCase c(std::move(volume), iso);
    c.scene.camera.projection = GetParam();
    return c;
  }
};

TEST_P(EnginesAgree, Blend) {
  VERNIER_NEEDS_GL(device);
  DvrCase c = of();
  for (double step : {1.0, 0.5}) {
    c.quality.step = step;
    for (auto how : {Classification::Post, Classification::Pre, Classification::PreIntegrated}) {
      SCOPED_TRACE(static_cast<int>(how));
      c.layer().classification = how;
      expectAgreement(c, "dvr.native");
    }
  }
}

TEST_P(EnginesAgree, ShadedByBothModels) {
  VERNIER_NEEDS_GL(device);
  DvrCase c = of();
  c.layer().classification = Classification::Post;
  for (auto model : {ShadingModel::GlobalAmbient, ShadingModel::ColourPerVoxel}) {
    c.layer().shading = model;
    expectAgreement(c, "dvr.native");
    c.scene.lights = {Light{}, Light{PatientVec(1, -1, 2), {0.4, 0.6, 1}}};
    expectAgreement(c, "dvr.native");
  }
}

TEST_P(EnginesAgree, CutOpenWithToolsAndNoData) {
  VERNIER_NEEDS_GL(device);
  DvrCase c = of(bumpyVolume(tiltedGrid(30, 28, 22), NoDataRange{0, 3}));
  c.layer().classification = Classification::Post;
  const glm::dvec3 centre = c.volume().grid().centre().p;
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.6, -0.5, 0.4));
  c.scene.clip = {{PatientVec(n), glm::dot(n, centre) + 3}};
  c.scene.crop = CropBox{VoxelPoint(2.3, 1.7, 1.1), VoxelPoint(26.4, 25.2, 19.8)};
  expectAgreement(c, "dvr.native");
  c.addTool(4, 5, 1);
  c.addTool(-3, 6, 0.4, {0.9, 0.1, 0.1});
  expectAgreement(c, "dvr.native");
}

TEST_P(EnginesAgree, Extremes) {
  VERNIER_NEEDS_GL(device);
  DvrCase c = of();
  for (auto mode : {VolumeMode::Max, VolumeMode::Min}) {
    c.layer().mode = mode;
    expectAgreement(c, "dvr.native");
  }
}

TEST_P(EnginesAgree, ColourVolumesAndLinearOpacity) {
  VERNIER_NEEDS_GL(device);
  DvrCase colours = of(colourVolume());
  colours.layer().gains = {1.2, 0.8, 2, 1.7};
  expectAgreement(colours, "dvr.native");
  DvrCase linear = of();
  linear.layer().opacity = OpacityRule::Linear;
  expectAgreement(linear, "dvr.native");
}

TEST_P(EnginesAgree, IsoSurfaces) {
  VERNIER_NEEDS_GL(device);
  DvrCase c = of(bumpyVolume(), true);
  expectAgreement(c, "iso.native");
  c.addTool(2, 5, 1);
  c.scene.lights = {Light{PatientVec(-1, -1, 0.5), {1, 1, 1}}, Light{PatientVec(1, 0, 0), {0.2, 0.4, 1}}};
  expectAgreement(c, "iso.native");
}

INSTANTIATE_TEST_SUITE_P(Both, EnginesAgree,
                         ::testing::Values(Projection::Orthographic, Projection::Perspective),
                         [](const auto& tested) {
                           return tested.param == Projection::Perspective ? "Perspective" : "Orthographic";
                         });

}  // namespace
}  // namespace vernier
