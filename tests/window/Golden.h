// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of the window against tests/golden/window. A missing golden is a failure; one at a time is renewed
// with VERNIER_RENEW_GOLDEN=NAME, to be looked at before it is committed.
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <iostream>
#include <string>

#include "TestPaths.h"
#include "vernier/picture/Compare.h"
#include "vernier/picture/Png.h"

namespace vernier::ui::test {

// Letters and lines are blended by the display's OpenGL, whose roundings differ between processors by a level
// or two; pictures themselves are equal. One pixel of a letter that moves is 100 levels and more.
inline constexpr int kGoldenMax = 12;
inline constexpr double kGoldenMean = 0.02;

// Empty when `seen` counts as the golden, else why not.
inline std::string differs(const Picture& golden, const Picture& seen, int most = kGoldenMax) {
  const Result<Difference> d = comparePictures(golden, seen);
  if (!d) return d.error().sentence;
  if (d->max <= most && d->mean <= kGoldenMean) return "";
  return "max " + std::to_string(d->max) + " at " + std::to_string(d->worstX) + "," +
         std::to_string(d->worstY) + " (allowed " + std::to_string(most) + "), mean " +
         std::to_string(d->mean) + " (allowed " + std::to_string(kGoldenMean) + ")";
}

// A golden that shows next to nothing would agree with next to everything.
inline void expectNotTrivial(const Picture& p) {
  std::array<std::size_t, 256> levels{};
  for (std::size_t i = 0; i < p.pixels.size(); i += static_cast<std::size_t>(p.channels))
    ++levels[p.pixels[i]];
  const std::size_t pixels = p.pixels.size() / static_cast<std::size_t>(p.channels);
  std::size_t used = 0, bright = 0;
  for (std::size_t v = 0; v < levels.size(); ++v) {
    used += levels[v] > pixels / 100'000;
    if (v >= 60) bright += levels[v];
  }
  EXPECT_GE(used, 100u) << "grey levels in use";
  EXPECT_GE(bright, pixels / 20) << "pixels that are not background";
}

inline std::string goldenPath(const std::string& name, const std::string& folder = "tests/golden/window") {
  return std::string(VERNIER_SOURCE_DIR) + "/" + folder + "/" + name + ".png";
}

// `most`: of looks through a volume single pixels at an outline go one way or the other with the last digit,
// which differs between instruction sets; the mean tells all else.
inline void expectGolden(const std::string& name, const Picture& seen,
                         const std::string& folder = "tests/golden/window", int most = kGoldenMax) {
  expectNotTrivial(seen);
  const char* renewed = std::getenv("VERNIER_RENEW_GOLDEN");
  if (renewed && name == renewed) {
    const Result<void> written = writePng(goldenPath(name, folder), seen);
    EXPECT_TRUE(written.ok());
    std::cout << "[  NOTE    ] " << folder << "/" << name << ".png is renewed: look at it\n";
    return;
  }
  const Result<Picture> golden = readPng(goldenPath(name, folder));
  const std::string why = golden ? differs(*golden, seen, most) : "there is no such golden";
  if (why.empty()) return;
  const std::string left = std::string(VERNIER_BUILD_DIR) + "/window-" + name + ".png";
  EXPECT_TRUE(writePng(left, seen).ok());
  ADD_FAILURE() << folder << "/" << name << ".png: " << why << "; this run's is window-" << name
                << ".png in the build folder";
}

}  // namespace vernier::ui::test
