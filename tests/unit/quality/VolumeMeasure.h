// SPDX-License-Identifier: GPL-3.0-or-later
// Population, truth and error of scenes that look through a volume.
#pragma once
#include <algorithm>

#include "Population.h"
#include "VolumeScenes.h"
#include "vernier/quality/Badge.h"

namespace vernier::test {

inline std::vector<char> maskOf(const VolumeScene& s) {
  const auto layers = quality::Layers::make(s.scene, s.view, s.sources, {});
  EXPECT_TRUE(layers.ok());
  std::vector<char> mask(static_cast<std::size_t>(s.view.width_px * s.view.height_px), 0);
  for (std::size_t p : quality::population(*layers, s.view)) mask[p] = 1;
  return mask;
}
inline std::size_t countOf(const std::vector<char>& mask) {
  return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1));
}

inline Frame frameOf(const VolumeScene& s) {
  const auto count = static_cast<std::size_t>(s.view.width_px * s.view.height_px);
  std::vector<std::size_t> all(count);
  for (std::size_t n = 0; n < count; ++n) all[n] = n;
  const auto truth = quality::referencePixels(s.scene, s.view, s.sources, all);
  EXPECT_TRUE(truth.ok());
  Frame frame;
  frame.images.allocate(s.view.width_px, s.view.height_px, false);
  for (std::size_t n = 0; n < count; ++n)
    for (int c = 0; c < 4; ++c)
      frame.images.colour[4 * n + static_cast<std::size_t>(c)] = static_cast<float>((*truth)[n].rgba[c]);
  return frame;
}
inline quality::ErrorReport measured(const Frame& frame, const VolumeScene& s) {
  quality::ErrorOptions options;
  options.samples = 1 << 20;
  const auto r = quality::measureError(frame, s.scene, s.view, s.sources, options);
  EXPECT_TRUE(r.ok());
  return r.ok() ? *r : quality::ErrorReport{};
}

}  // namespace vernier::test
