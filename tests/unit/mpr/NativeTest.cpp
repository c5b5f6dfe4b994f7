// SPDX-License-Identifier: GPL-3.0-or-later
// mpr.native and image.native as the planner and the session use them.
#include <gtest/gtest.h>

#include <cmath>

#include "../volume/Grids.h"
#include "SliceParams.h"
#include "vernier/plan/MakePlan.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Voi.h"

namespace vernier::mpr::test {
namespace {

using vernier::test::bufferOf;
using vernier::test::everyGrid;
using vernier::test::randomValues;
using vernier::test::volumeOf;

struct Desk {
  Scene scene;
  View view;
  Quality quality;
  Capabilities capabilities;
  CostTable costs;
  Sources sources;
  PlanContext context() const { return {scene, view, quality, capabilities, costs, sources}; }
  Result<Plan> plan() const {
    TechniqueRegistry registry;
    for (Technique t : {nativeImageTechnique(), nativeSliceTechnique()})
      EXPECT_TRUE(registry.add(std::move(t)).ok());
    return makePlan(scene, view, quality, capabilities, costs, sources, registry);
  }
  Images draw() const {
    Images images;
    const Result<Plan> p = plan();
    EXPECT_TRUE(p.ok()) << (p.ok() ? "" : p.error().text());
    if (!p) return images;
    EXPECT_EQ(p->passes.size(), 1u);
    const Technique t =
        p->passes[0].technique == "mpr.native" ? nativeSliceTechnique() : nativeImageTechnique();
    EXPECT_TRUE(t.execute(p->passes[0], images, {}).ok());
    return images;
  }
};

Desk sliceDesk(std::int16_t low = -1000, std::int16_t high = 3000, bool inverted = false) {
  VolumeInfo info;
  info.grid = everyGrid()[1].grid;
  info.inverted = inverted;
  info.rescale = {{1.5, -20}};
  info.windows = {{100, 700, VoiFunction::Linear, ""}};
  Desk d;
  d.sources.volumes["a"] = volumeOf<std::int16_t>(info, randomValues<std::int16_t>(7 * 6 * 9, 3, low, high));
  SliceLayer layer;
  layer.source = "a";
  layer.plane.point = info.grid.centre();
  layer.plane.normal = PatientVec(0.3, -0.4, 0.8);
  layer.plane.up = PatientVec(0, 1, 0.1);
  d.scene.layers = {layer};
  d.scene.background = {0.125, 0.25, 0.5};
  d.view = {50, 40, true};
  return d;
}

SliceLayer& sliceOf(Desk& d) { return std::get<SliceLayer>(d.scene.layers[0]); }

TEST(NativeSlice, DrawsTheLayerThroughThePlanner) {
  Desk d = sliceDesk();
  sliceOf(d).slab = {5, SlabMode::Mean};
  d.quality.step = 0.5;
  const Images images = d.draw();
  const Volume& v = *d.sources.volumes["a"];
  const auto picture = slicePicture(sliceOf(d), d.scene.camera, d.view, v);
  ASSERT_TRUE(picture.ok());
  const int samples = 15;  // ceil(5 mm / (0.5 * 0.7 mm))
  int shown = 0;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 50; ++x) {
      double sum = 0;
      int n = 0;
      for (int k = 0; k < samples; ++k)
        if (const auto m =
                sampleModality(v, picture->origin + (x + 0.5) * picture->right + (y + 0.5) * picture->down +
                                      ((k + 0.5) * 5 / samples - 2.5) * picture->normal))
          sum += *m, ++n;
      const std::size_t i = static_cast<std::size_t>(50 * y + x);
      if (n == 0) {
        ASSERT_TRUE(std::isnan(images.values[i]));
        ASSERT_EQ(images.colour[4 * i + 2], 0.5f);
        continue;
      }
      ++shown;
      ASSERT_NEAR(images.values[i], sum / n, 0.02);
      ASSERT_NEAR(images.colour[4 * i], applyVoi({100, 700, VoiFunction::Linear, ""}, sum / n), 1e-4);
    }
  EXPECT_GT(shown, 500);
}

TEST(NativeSlice, ParametersAreResolved) {
  Desk d = sliceDesk(-1000, 3000, true);
  sliceOf(d).invert = true;
  auto p = sliceParams(d.scene.layers[0], d.context());
  ASSERT_TRUE(p.ok());
  EXPECT_FALSE((*p)->invert);  // one inversion in all
  EXPECT_EQ((*p)->slabSamples, 1);
  EXPECT_EQ((*p)->window.center, 100);
  sliceOf(d).invert = false;
  sliceOf(d).window = VoiWindow{5, 0.5, VoiFunction::Linear, ""};
  sliceOf(d).slab.thickness_mm = 0.7001;
  p = sliceParams(d.scene.layers[0], d.context());
  ASSERT_TRUE(p.ok());
  EXPECT_TRUE((*p)->invert);
  EXPECT_EQ((*p)->slabSamples, 2);
  EXPECT_EQ((*p)->window.function, VoiFunction::LinearExact);
}

TEST(NativeSlice, RefusesWhatCannotBeDrawn) {
  const auto codeOf = [](const Desk& d) {
    const auto p = sliceParams(d.scene.layers[0], d.context());
    EXPECT_FALSE(p.ok());
    return p.ok() ? ErrorCode::Internal : p.error().code;
  };
  for (const double mm : {-1.0, 2e6, std::nan("")}) {
    Desk d = sliceDesk();
    sliceOf(d).slab.thickness_mm = mm;
    EXPECT_EQ(codeOf(d), ErrorCode::SceneInvalid);
  }
  Desk d = sliceDesk();
  sliceOf(d).window = VoiWindow{5, 0, VoiFunction::Linear, ""};
  EXPECT_EQ(codeOf(d), ErrorCode::SceneInvalid);
  d = sliceDesk();
  sliceOf(d).plane.up = sliceOf(d).plane.normal;
  EXPECT_EQ(codeOf(d), ErrorCode::PlaneDegenerate);
  d = sliceDesk();
  sliceOf(d).source = "other";
  EXPECT_EQ(codeOf(d), ErrorCode::SceneInvalid);
}

TEST(NativeSlice, MeasuredCostWinsOverTheBuiltIn) {
  Desk d = sliceDesk();
  d.costs.nsPerSample["mpr.native"] = 1000;
  const auto plan = d.plan();
  ASSERT_TRUE(plan.ok());
  EXPECT_NEAR(plan->passes[0].predicted_ms, 50 * 40 * 1e-3, 1e-9);
  EXPECT_LT(plan->passes[0].predictedError, 0.5);
}

// A frame of 5 columns and 4 rows, values 10 * row + column, one padding pixel at (2, 1).
Desk imageDesk(ImageFrameInfo info = {}) {
  info.columns = 5;
  info.rows = 4;
  info.rescale = {2, -7};
  info.noData = NoDataRange{12, 12};
  if (info.windows.empty()) info.windows = {{30, 80, VoiFunction::LinearExact, ""}};
  std::vector<std::int16_t> values;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 5; ++column) values.push_back(static_cast<std::int16_t>(10 * row + column));
  auto frame = ImageFrame::make(info, bufferOf(values));
  EXPECT_TRUE(frame.ok());
  Desk d;
  d.sources.images[{"a", 0}] = *frame;
  ImageLayer layer;
  layer.source = "a";
  layer.interpolation = Interpolation::Nearest;
  d.scene.layers = {layer};
  d.scene.background = {0.125, 0.25, 0.5};
  d.view = {5, 4, true};
  return d;
}

ImageLayer& imageOf(Desk& d) { return std::get<ImageLayer>(d.scene.layers[0]); }

TEST(NativeImage, OneToOneShowsEveryStoredPixel) {
  for (const Interpolation interpolation : {Interpolation::Nearest, Interpolation::Linear})
    for (const bool flipX : {false, true})
      for (const bool flipY : {false, true}) {
        Desk d = imageDesk();
        imageOf(d).interpolation = interpolation;
        imageOf(d).flipHorizontal = flipX;
        imageOf(d).flipVertical = flipY;
        const Images images = d.draw();
        for (int y = 0; y < 4; ++y)
          for (int x = 0; x < 5; ++x) {
            const int column = flipX ? 4 - x : x, row = flipY ? 3 - y : y;
            const std::size_t i = static_cast<std::size_t>(5 * y + x);
            const double m = 2.0 * (10 * row + column) - 7;
            if (column == 2 && row == 1) {
              EXPECT_TRUE(std::isnan(images.values[i]));
              EXPECT_EQ(images.depth[i], kNothing_mm);
              EXPECT_EQ(images.colour[4 * i + 1], 0.25f);
            } else {
              EXPECT_EQ(images.values[i], static_cast<float>(m));
              EXPECT_EQ(images.depth[i], 0.0f);
              EXPECT_FLOAT_EQ(images.colour[4 * i], static_cast<float>(std::clamp((m + 10) / 80, 0.0, 1.0)));
            }
          }
        EXPECT_EQ(images.counters.samples, 20u);
      }
}

TEST(NativeImage, PixelAspectAndBilinearZoom) {
  ImageFrameInfo info;
  info.pixelSpacing_mm = {2.0, 1.0};  // rows 2 mm apart, columns 1 mm
  Desk d = imageDesk(info);
  d.view = {50, 80, true};
  imageOf(d).interpolation = Interpolation::Linear;
  const Images images = d.draw();
  int blended = 0;
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 50; ++x) {
      // 10 pixels per column, 20 per row.
      const double cx = std::clamp((x + 0.5) / 10 - 0.5, 0.0, 4.0),
                   cy = std::clamp((y + 0.5) / 20 - 0.5, 0.0, 3.0);
      const bool nearPadding = std::abs(cx - 2) < 1 && std::abs(cy - 1) < 1;
      if (nearPadding) continue;
      ASSERT_NEAR(images.values[static_cast<std::size_t>(50 * y + x)], 2 * (10 * cy + cx) - 7, 1e-5);
      ++blended;
    }
  EXPECT_GT(blended, 2000);
  // Beside the padding pixel only its valid neighbours count: half way to (3, 1), level with row 1.
  const std::size_t beside = 50 * 29 + 30;  // column 2.55, row 0.975
  const double wx = 0.55, wy = 0.975;
  const double truth = ((1 - wx) * (1 - wy) * 2 + wx * (1 - wy) * 3 + wx * wy * 13) /
                       ((1 - wx) * (1 - wy) + wx * (1 - wy) + wx * wy);
  EXPECT_NEAR(images.values[beside], 2 * truth - 7, 1e-5);
}

TEST(NativeImage, LookupTablesAndOneInversion) {
  ImageFrameInfo info;
  info.inverted = true;
  LutTable lut;
  lut.firstMapped = 10;
  lut.bits = 8;
  lut.data = {0, 51, 102, 153, 204, 255};
  info.voiLuts = {lut};
  Desk d = imageDesk(info);
  imageOf(d).voiLut = 0;
  const Images images = d.draw();
  // Modality of pixel (0, 0) is -7 -> first entry 0, inverted 1; of (0, 1) it is 13 -> entry 3.
  EXPECT_FLOAT_EQ(images.colour[0], 1.0f);
  EXPECT_FLOAT_EQ(images.colour[4 * 5], 1.0f - 0.6f);
  EXPECT_FLOAT_EQ(images.colour[4 * 19], 0.0f);  // beyond the last entry
  imageOf(d).invert = true;
  EXPECT_FLOAT_EQ(d.draw().colour[4 * 5], 0.6f);
  imageOf(d).voiLut = 1;
  EXPECT_FALSE(d.plan().ok());
}

}  // namespace
}  // namespace vernier::mpr::test
