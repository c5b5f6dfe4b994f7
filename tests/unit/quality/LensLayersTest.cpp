// SPDX-License-Identifier: GPL-3.0-or-later
// The reference with lenses as the badge sees it: on slices, edges, population, what is refused.
#include <cmath>

#include "Layers.h"
#include "LensScenes.h"
#include "Population.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

// A box of ten voxels, of which a lens holds columns 3 to 6 and rows 2 to 5, faces included.
TEST(LensLayers, SlicesAskThePixelsPoint) {
  const auto volume =
      floatVolume(gridOf(10, 10, 3), [](auto i, auto, auto) { return 0.1 * static_cast<double>(i); });
  for (const bool cut : {false, true}) {
    LensScene s(VolumeScene{});
    SliceScene slice = sliceScene(
        volume, Plane{volume->grid().centre(), PatientVec(0, 0, -1), PatientVec(0, -1, 0)}, 10, 10);
    s.scene = slice.scene, s.view = slice.view, s.sources = slice.sources;
    s.scene.background = {0.25, 0.5, 0.75};
    SliceLook look;
    look.window = VoiWindow{0.5, 1, VoiFunction::LinearExact, ""}, look.invert = true;
    s.lens(boxRegion({3, 2, 0}, {6, 5, 3}), cut ? LensInner(CutOut{}) : LensInner(look));
    std::vector<std::size_t> all;
    for (std::size_t p = 0; p < 100; ++p) all.push_back(p);
    const auto got = s.pixels(all);
    ASSERT_TRUE(got.ok()) << got.error().text();
    const auto layers = Layers::make(s.scene, s.view, s.sources, s.options);
    for (std::size_t p : all) {
      const std::size_t x = p % 10, y = p / 10;
      const bool in = x >= 3 && x <= 6 && y >= 2 && y <= 5;
      const double v = 0.1 * static_cast<double>(x);
      const glm::dvec3 is = !in ? glm::dvec3(v) : cut ? glm::dvec3(0.25, 0.5, 0.75) : glm::dvec3(1 - v);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR((*got)[p].rgba[c], is[c], 1e-7) << p;
      EXPECT_EQ((*got)[p].covered, !(in && cut));
      // The lens's border is an edge.
      const bool border = x >= 2 && x <= 7 && y >= 1 && y <= 6 && !(x >= 4 && x <= 5 && y >= 3 && y <= 4);
      if (x > 0 && x < 9 && y > 0 && y < 9) {
        EXPECT_EQ(layers->atEdge(centreOf(p, s.view)), border) << p;
      }
    }
  }
}

// The silhouette of a lens is an edge where something is seen of it, and nowhere else.
TEST(LensLayers, EdgesRunAroundLenses) {
  VolumeScene v =
      volumeScene(floatVolume(gridOf(20, 20, 20), [](auto, auto, auto k) { return k < 10 ? 1.0 : 0.0; }),
                  projectionOf(ProjectionMode::Sum));
  v.view = {40, 40}, v.scene.camera.height_mm = 20;
  IsosurfaceLayer iso;
  iso.source = "v", iso.level = 0.5;
  for (const Layer& base : {v.scene.layers[0], Layer(iso)}) {
    LensScene s(v);
    s.scene.layers[0] = base;
    s.lens(boxRegion({5.1, 5.1, 5.1}, {14.1, 14.1, 14.1}), CutOut{});
    const auto layers = Layers::make(s.scene, s.view, s.sources, s.options);
    ASSERT_TRUE(layers.ok());
    const bool isSum = std::holds_alternative<ProjectionLayer>(base);
    const auto edge = [&](double x, double z) {
      return layers->atEdge({std::floor((x - 9.5) * 2 + 20) + 0.5, std::floor((9.5 - z) * 2 + 20) + 0.5});
    };
    // The iso-surface begins before the lens: nothing of the lens is seen.
    EXPECT_EQ(edge(5.1, 8), isSum);
    EXPECT_EQ(edge(14.1, 8), isSum);
    EXPECT_EQ(edge(9, 5.1), isSum);
    EXPECT_FALSE(edge(9, 8));
    EXPECT_FALSE(edge(2, 3));
    EXPECT_EQ(edge(5.1, 13), isSum);  // nothing to be seen of the iso-surface with or without it
  }
}

// A lens that holds all of the ray is told from none, and where a slanted cut begins.
TEST(LensLayers, EdgesOfWholeRaysAndCuts) {
  VolumeScene v = volumeScene(floatVolume(gridOf(20, 20, 20), [](auto, auto, auto) { return 1.0; }),
                              projectionOf(ProjectionMode::Max));
  v.view = {40, 40}, v.scene.camera.height_mm = 20;
  // Leaves y from 9.5 - x on: half of the picture begins at it.
  v.scene.clip.push_back({PatientVec(glm::normalize(glm::dvec3(-1, -1, 0))), -9.5 * std::sqrt(0.5)});
  LensScene s(v);
  s.lens(boxRegion({-9, -9, 5.1}, {30, 30, 14.1}), projectionOf(ProjectionMode::Sum));
  const auto layers = Layers::make(s.scene, s.view, s.sources, s.options);
  ASSERT_TRUE(layers.ok());
  const auto edge = [&](double x, double z) {
    return layers->atEdge({std::floor((x - 9.5) * 2 + 20) + 0.5, std::floor((9.5 - z) * 2 + 20) + 0.5});
  };
  EXPECT_TRUE(edge(4, 5.1));
  EXPECT_TRUE(edge(15, 14.1));
  EXPECT_TRUE(edge(9.5, 10));
  EXPECT_TRUE(edge(9.5, 2));
  EXPECT_FALSE(edge(4, 10));
  EXPECT_FALSE(edge(15, 10));
  EXPECT_FALSE(edge(15, 2));
}

// What no pixel outside the population shows: the background, with and without.
TEST(LensLayers, ThePopulationHoldsWhatLensesShow) {
  int outside = 0, insideOnly = 0;
  for (std::uint64_t n = 0; n < 12; ++n) {
    // A ball of value 1 in air; the outside shows above 0.5 only, the lens from 0.01 on.
    VolumeLayer bone = blendOf({1, 1, 1}, 0);
    bone.transfer->opacities = {{0.5, 0}, {0.6, 0.5}};
    VolumeLayer skin = blendOf({1, 0.5, 0.2}, 0);
    skin.transfer->opacities = {{0.01, 0}, {0.05, 0.5}};
    VolumeScene v = volumeScene(floatVolume(gridOf(40, 40, 40),
                                            [](auto i, auto j, auto k) {
                                              const glm::dvec3 p(i - 12, j - 12, k - 12);
                                              return glm::length(p) < 8 ? 1.0 : i > 20 ? 0.1 : 0.0;
                                            }),
                                bone);
    v.view = {60, 50};
    v.scene.camera.azimuth_deg = 40.0 * static_cast<double>(n), v.scene.camera.height_mm = 60;
    if (n % 2) v.scene.camera.projection = Projection::Perspective;
    LensScene s(v);
    const double x = 14 + static_cast<double>(n);
    s.lens(boxRegion({x, 10, 8}, {x + 9, 31, 26}), n % 3 == 2 ? LensInner(CutOut{}) : LensInner(skin));
    const auto layers = Layers::make(s.scene, s.view, s.sources, s.options);
    ASSERT_TRUE(layers.ok());
    std::vector<char> mask(3000, 0);
    for (std::size_t p : population(*layers, s.view)) mask[p] = 1;
    LensScene bare(v);
    const auto without = Layers::make(bare.scene, bare.view, bare.sources, bare.options);
    std::vector<char> plain(3000, 0);
    for (std::size_t p : population(*without, bare.view)) plain[p] = 1;
    for (std::size_t p = 0; p < 3000; ++p) {
      EXPECT_GE(mask[p], plain[p]);
      insideOnly += mask[p] && !plain[p] ? 1 : 0;
      if (mask[p]) continue;
      ++outside;
      EXPECT_LT(glm::length(glm::dvec3(layers->at(centreOf(p, s.view)).rgba)), 1e-12) << n << " pixel " << p;
    }
    if (n % 3 == 2) {
      EXPECT_EQ(mask, plain);
    }
  }
  EXPECT_GT(outside, 3000);
  EXPECT_GT(insideOnly, 500);
}

TEST(LensLayers, WhatItCannotDrawIsRefused) {
  const auto code = [](const LensScene& s) {
    const auto got = s.pixels({0});
    return got.ok() ? ErrorCode::Internal : got.error().code;
  };
  LensScene s(fourVoxels(blendOf({1, 0, 0}, 0.3), kOne));
  s.sheetLens(1, 2, CutOut{});
  LensScene absent = s;
  absent.options.lenses.reset();  // faces not given
  EXPECT_EQ(code(absent), ErrorCode::NotBuiltYet);
  LensScene misses = s;
  misses.options.lenses->clear();  // it shows nothing: as without
  misses.expect({1 - std::pow(0.7, 3), 0, 0});
  LensScene wrong = s;
  wrong.options.lenses->front().layer = 0;
  EXPECT_EQ(code(wrong), ErrorCode::SceneInvalid);
  LensScene alone = s;
  alone.scene.layers.erase(alone.scene.layers.begin());
  EXPECT_EQ(code(alone), ErrorCode::SceneInvalid);
  const auto inside = [&](LensInner inner) {
    LensScene t = s;
    std::get<LensLayer>(t.scene.layers[1]).inner = std::move(inner);
    return code(t);
  };
  EXPECT_EQ(inside(SliceLook{}), ErrorCode::SceneInvalid);
  VolumeLayer most = blendOf({1, 1, 1}, 0.5);
  most.mode = VolumeMode::Max;
  EXPECT_EQ(inside(most), ErrorCode::NotBuiltYet);
  ProjectionLayer inverted = projectionOf(ProjectionMode::Max);
  inverted.invert = true;
  EXPECT_EQ(inside(inverted), ErrorCode::NotBuiltYet);
  ProjectionLayer elsewhere = projectionOf(ProjectionMode::Max);
  elsewhere.source = "w";
  EXPECT_EQ(inside(elsewhere), ErrorCode::SceneInvalid);
}

}  // namespace
}  // namespace vernier::quality
