// SPDX-License-Identifier: GPL-3.0-or-later
// What the GL techniques of volumes accept, refuse with which numbers, and promise.
#include <gmock/gmock.h>

#include "GlCases.h"

namespace vernier::test {
namespace {

using ::testing::HasSubstr;

class GlVolumePlan : public ::testing::Test {
 protected:
  GlVolumePlan() {
    machine.gl = true, machine.max3dTexture = 256, machine.maxTexture = 1024;
    c.quality.level = QualityLevel::Review;
  }
  Result<std::vector<Pass>> ask(const std::string& technique) {
    const DvrHost& host = DvrHost::instance();
    const Technique* t = host.registry.find(technique);
    EXPECT_NE(t, nullptr) << technique;
    PlanContext context{c.scene, c.view, c.quality, machine, costs, c.sources};
    context.tools = *placedSurfaces(c.scene, c.sources);
    return t->passesFor(c.scene.layers[0], 0, context);
  }
  std::string refused(const std::string& technique) {
    const auto r = ask(technique);
    EXPECT_FALSE(r.ok());
    return r.ok() ? std::string() : r.error().sentence;
  }
  void show(std::shared_ptr<const Volume> v) { c.sources.volumes["v"] = std::move(v); }
  static std::shared_ptr<const Volume> flat(const GridGeometry& grid) {
    VolumeInfo info;
    info.grid = grid;
    return volumeOf(
        info, std::vector<std::int16_t>(static_cast<std::size_t>(grid.columns * grid.rows * grid.slices), 3));
  }
  DvrCase c;
  Capabilities machine;
  CostTable costs;
};

TEST_F(GlVolumePlan, RaysStateTheirTextureAndWhatTheyDo) {
  const auto passes = ask("dvr.rays");
  ASSERT_TRUE(passes.ok()) << passes.error().text();
  ASSERT_EQ(passes->size(), 1u);
  const Pass& pass = passes->front();
  EXPECT_EQ(pass.resources.at(0).name, "texture3d");
  EXPECT_EQ(pass.resources.at(0).bytes, 30u * 28 * 22 * 2);
  EXPECT_EQ(pass.params->dump(), "blend, orthographic, step 0.8 mm, post");
  EXPECT_EQ(pass.gl.blend, "off");
  EXPECT_GT(pass.predicted_ms, 0);
  const double coarse = pass.predictedError;
  c.quality.step = 0.25;
  EXPECT_LT(ask("dvr.rays")->front().predictedError, 0.3 * coarse);
  EXPECT_GT(ask("dvr.rays")->front().predicted_ms, 2 * pass.predicted_ms - 20);
  costs.nsPerSample["dvr.rays"] = 1e6;
  EXPECT_GT(ask("dvr.rays")->front().predicted_ms, 100 * pass.predicted_ms);
}

TEST_F(GlVolumePlan, ALayerSaysAllOfItself) {
  c.layer().shading = ShadingModel::ColourPerVoxel, c.layer().classification = Classification::PreIntegrated;
  c.layer().opacity = OpacityRule::Linear;
  c.scene.camera.projection = Projection::Perspective;
  c.scene.clip = {{PatientVec(1, 0, 0), 0}};
  c.addTool(0, 3, 0.5);
  EXPECT_EQ(
      ask("dvr.rays")->front().params->dump(),
      "blend, perspective, step 0.8 mm, pre-integrated, linear opacity, colour per voxel, lights 1, cut by 1 "
      "planes, tools 1");
  c = DvrCase(bumpyVolume(), true);
  EXPECT_EQ(ask("dvr.rays")->front().params->dump(), "iso 60, orthographic, step 0.8 mm, lights 1");
}

TEST_F(GlVolumePlan, RaysRefuseWhatA3dTextureCannotHold) {
  show(flat(everyGrid()[4].grid));
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("unevenly"));
  show(flat(unitGrid(300, 2, 2)));
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("300 voxels on a side; 3-D textures here take up to 256"));
  machine.glTextureBudget_bytes = 2 << 20;
  show(flat(unitGrid(200, 200, 50)));
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("3 MB as a texture and GL may hold 2 MB"));
  show(flat(unitGrid(20, 20, 10)));
  c.view = {2000, 10};
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("2000"));
}

TEST_F(GlVolumePlan, StacksStateTheirOneStack) {
  const auto passes = ask("dvr.stacks");
  ASSERT_TRUE(passes.ok()) << passes.error().text();
  const Pass& pass = passes->front();
  EXPECT_EQ(pass.resources.at(0).name, "texture2d x 28");
  EXPECT_EQ(pass.resources.at(0).bytes, 30u * 28 * 22 * 2);
  EXPECT_EQ(pass.params->dump(),
            "blend, orthographic, step 0.8 mm, post; stack across y x1, 1 slice per polygon");
  EXPECT_EQ(pass.gl.blend, "remaining");
  c.quality.step = 0.25;
  EXPECT_THAT(ask("dvr.stacks2")->front().params->dump(),
              HasSubstr("stack across y x4, 2 slices per polygon"));
  EXPECT_THAT(ask("dvr.stacks2-uncorrected")->front().params->dump(), HasSubstr(", uncorrected"));
  EXPECT_GT(ask("dvr.stacks2-uncorrected")->front().predictedError, 30);
  EXPECT_LT(ask("dvr.stacks2")->front().predicted_ms, ask("dvr.stacks")->front().predicted_ms);
  c.layer().shading = ShadingModel::ColourPerVoxel;
  EXPECT_EQ(ask("dvr.stacks")->front().resources.at(0).bytes, 30u * 28 * 22 * 16);
  EXPECT_TRUE(ask("dvr.stacks")->front().notes.empty());
  machine.glTextureBudget_bytes = 100000;
  EXPECT_THAT(ask("dvr.stacks")->front().notes.at(0), HasSubstr("uploaded anew"));
}

TEST_F(GlVolumePlan, StacksRefuseWhatTheyCannotDraw) {
  show(flat(unitGrid(1100, 2, 2)));
  EXPECT_THAT(refused("dvr.stacks"), HasSubstr("1100 voxels on a side; GL textures here take up to 1024"));
  show(flat(everyGrid()[5].grid));
  EXPECT_THAT(refused("dvr.stacks"), HasSubstr("gaps"));
  show(bumpyVolume());
  c.layer().classification = Classification::PreIntegrated;
  EXPECT_THAT(refused("dvr.stacks"), HasSubstr("Pre-integrated"));
  c.layer().classification.reset();
  c.layer().mode = VolumeMode::Max;
  EXPECT_THAT(refused("dvr.stacks2-uncorrected"), HasSubstr("compared"));
  c.addTool(0, 3, 0.5);
  EXPECT_THAT(refused("dvr.stacks"), HasSubstr("translucent"));
}

TEST_F(GlVolumePlan, SlabsSayHowManyAndWhatTheBudgetHolds) {
  const auto whole = ask("dvr.slabs");
  ASSERT_TRUE(whole.ok()) << whole.error().text();
  EXPECT_THAT(whole->front().params->dump(), HasSubstr("; 1 slab of 22 slices"));
  machine.glTextureBudget_bytes = 8 * 30 * 28 * 2;
  const auto three = ask("dvr.slabs");
  EXPECT_THAT(three->front().params->dump(), HasSubstr("; 3 slabs of 8 slices"));
  EXPECT_EQ(three->front().resources.at(0).name, "texture3d, one of 3");
  EXPECT_EQ(three->front().resources.at(0).bytes, machine.glTextureBudget_bytes);
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("slabs take it in parts"));
  EXPECT_THAT(ask("dvr.strips")->front().params->dump(), HasSubstr("; 21 strips"));
  // Strips are never the planner's choice.
  EXPECT_GT(ask("dvr.strips")->front().predicted_ms, 2 * three->front().predicted_ms);
  machine.glTextureBudget_bytes = 3000;
  EXPECT_THAT(refused("dvr.slabs"),
              HasSubstr("Two slices of the volume need 3 KB as textures and GL may hold 2 KB"));
  machine.glTextureBudget_bytes = 1 << 30;
  show(flat(unitGrid(300, 2, 2)));
  EXPECT_THAT(refused("dvr.slabs"), HasSubstr("300 voxels on a side; 3-D textures here take up to 256"));
  show(flat(unitGrid(20, 20, 400)));
  EXPECT_THAT(ask("dvr.slabs")->front().params->dump(), HasSubstr("; 2 slabs of 256 slices"));
}

TEST_F(GlVolumePlan, WhatHasNoInsideOrNoMeaningIsRefused) {
  show(flat(unitGrid(5, 5, 1)));
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("single slice"));
  show(flat(unitGrid(1, 1, 1)));
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("single slice"));
  show(bumpyVolume());
  c.layer().transfer->opacities = {{0, std::nan("")}};
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("between 0 and 1"));
  c.layer().transfer->opacities = {};
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("no opacities"));
  c.layer().transfer.reset();
  c.layer().preset = "nothing";
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("nothing"));
  c.layer().preset = "";
  EXPECT_TRUE(ask("dvr.rays").ok());
  show(colourVolume());
  c.layer().shading = ShadingModel::ColourPerVoxel;
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("colour volume"));
  c = DvrCase(colourVolume(), true);
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("no iso-surfaces"));
}

TEST_F(GlVolumePlan, TranslucentToolsAmongExtremesAreRefused) {
  c.layer().mode = VolumeMode::Max;
  c.addTool(0, 3, 1);
  EXPECT_TRUE(ask("dvr.rays").ok());
  c.addTool(0, 3, 0.5);
  EXPECT_THAT(refused("dvr.rays"), HasSubstr("translucent"));
  c.layer().mode = VolumeMode::Blend;
  EXPECT_TRUE(ask("dvr.rays").ok());
}

}  // namespace
}  // namespace vernier::test
