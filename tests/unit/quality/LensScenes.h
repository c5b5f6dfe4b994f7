// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes with lenses that are made by hand.
#pragma once
#include <string>

#include "ConvexBox.h"
#include "VolumeScenes.h"

namespace vernier::test {

inline constexpr double kRamp[4] = {0, 1, 2, 3};  // the value is y
inline constexpr double kOne[4] = {1, 1, 1, 1};

struct LensScene : VolumeScene {
  quality::ReferenceOptions options;
  // Before the first lens: none.
  LensScene(VolumeScene s) : VolumeScene(std::move(s)) { options.lenses.emplace(); }
  void lens(std::shared_ptr<const ConvexRegion> region, LensInner inner) {
    options.lenses->push_back({std::move(region), scene.layers.size()});
    LensLayer layer;
    layer.inner = std::move(inner);
    scene.layers.emplace_back(layer);
  }
  // Holds y from `from` to `to`.
  void sheetLens(double from, double to, LensInner inner) {
    lens(boxRegion({-50, from, -50}, {50, to, 50}), std::move(inner));
  }
  Result<std::vector<quality::ReferencePixel>> pixels(const std::vector<std::size_t>& at) const {
    return quality::referencePixels(scene, view, sources, at, options);
  }
  void expect(glm::dvec3 is, double within = 1e-9) const {
    const auto got = pixels({0});
    ASSERT_TRUE(got.ok()) << got.error().text();
    for (int c = 0; c < 3; ++c) EXPECT_NEAR((*got)[0].rgba[c], is[c], within) << "channel " << c;
  }
};

inline VolumeLayer blendOf(glm::dvec3 colour, double opacity) {
  VolumeLayer v;
  v.source = "v", v.transfer = TransferFunction{{{0, colour}}, {{0, opacity}}, 1};
  return v;
}
inline ProjectionLayer projectionOf(ProjectionMode mode, double gain = 0.1) {
  ProjectionLayer p;
  p.source = "v", p.mode = mode, p.gain_perMm = gain;
  p.window = VoiWindow{2, 4, VoiFunction::LinearExact, ""};  // a quarter of the value
  return p;
}

}  // namespace vernier::test
