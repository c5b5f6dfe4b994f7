// SPDX-License-Identifier: GPL-3.0-or-later
// The window as it looks after what a reader does first: scroll, window, MPR, crosshair, one picture alone,
// undo. And that the comparison sees what it must see.
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cmath>

#include "Golden.h"
#include "WindowDriver.h"
#include "WindowStudies.h"

namespace vernier::ui {
namespace {

using test::expectGolden;
using test::headStudy;
using test::WindowDriver;

constexpr const char* kGoldens[] = {"stack-windowed", "mpr-crosshair", "maximised", "undone",
                                    "mpr-crosshair-200"};

// A screenshot with the pointer out of the way.
Picture seen(WindowDriver& w) {
  w.move(2, 2);
  return w.screenshot();
}

TEST(WindowGolden, AFirstReading) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  w.open(headStudy(dir));
  w.move(780, 420);
  w.wheel(-6);
  ASSERT_TRUE(w.settle());
  w.dragBy(780, 420, 150, 30);
  expectGolden("stack-windowed", seen(w));

  w.key(GLFW_KEY_F4);
  w.key(GLFW_KEY_1);
  w.key(GLFW_KEY_C);
  ASSERT_TRUE(w.settle());
  w.dragBy(540, 250, 35, -40);
  expectGolden("mpr-crosshair", seen(w));

  w.doubleClick(1030, 250);
  ASSERT_EQ(w.workspace().shown(), std::vector<int>{1});
  expectGolden("maximised", seen(w));

  w.key(GLFW_KEY_Z, true);  // four pictures again
  w.key(GLFW_KEY_Z, true);  // the crosshair where it was at first
  expectGolden("undone", seen(w));
}

TEST(WindowGolden, MprAtTwiceTheScale) {
  vernier::test::TempDir dir;
  HostOptions options;
  options.scale = 2;
  options.width = 900, options.height = 600;
  WindowDriver w(options);
  if (!w.here()) return;
  w.open(headStudy(dir));
  w.key(GLFW_KEY_F4);
  w.key(GLFW_KEY_C);
  ASSERT_TRUE(w.settle());
  w.dragBy(840, 420, 60, 40);
  expectGolden("mpr-crosshair-200", seen(w));
}

Picture shifted(const Picture& p) {
  Picture out = p;
  for (int y = 0; y < p.height; ++y)
    for (int x = p.width - 1; x > 0; --x) std::copy_n(p.at(x - 1, y), p.channels, out.at(x, y));
  return out;
}
Picture swapped(const Picture& p) {
  Picture out = p;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) std::copy_n(p.at(p.width - 1 - x, y), p.channels, out.at(x, y));
  return out;
}
Picture withGamma(Picture p, double gamma) {
  for (std::uint8_t& v : p.pixels)
    v = static_cast<std::uint8_t>(std::lround(255 * std::pow(static_cast<double>(v) / 255, gamma)));
  return p;
}
Picture blank(Picture p) {
  std::fill(p.pixels.begin(), p.pixels.end(), std::uint8_t{0});
  return p;
}
// The first letter at the picture's right edge, or whatever bright object stands last, is painted over.
Picture withoutAnObject(Picture p) {
  for (int y = p.height / 4; y < p.height; ++y)
    for (int x = p.width - 1; x > p.width / 2; --x) {
      if (*p.at(x, y) < 180) continue;
      for (int v = y; v < std::min(p.height, y + 14); ++v)
        std::fill_n(p.at(x - 12, v), 13 * p.channels, std::uint8_t{0});
      return p;
    }
  ADD_FAILURE() << "there is nothing to take away";
  return p;
}
// One letter's height of one column.
Picture withAScratch(Picture p) {
  for (int y = p.height / 2; y < p.height / 2 + 12; ++y) {
    std::uint8_t& v = *p.at(p.width / 3, y);
    v = static_cast<std::uint8_t>(v > 127 ? v - 60 : v + 60);
  }
  return p;
}

TEST(WindowGolden, TheComparisonSeesWhatIsWrong) {
  for (const char* name : kGoldens) {
    const Result<Picture> golden = readPng(test::goldenPath(name));
    ASSERT_TRUE(golden.ok()) << name;
    test::expectNotTrivial(*golden);
    EXPECT_EQ(test::differs(*golden, *golden), "") << name;
    const std::pair<const char*, Picture> wrong[] = {{"one pixel to the right", shifted(*golden)},
                                                     {"left and right exchanged", swapped(*golden)},
                                                     {"gamma 1.05", withGamma(*golden, 1.05)},
                                                     {"gamma 0.97", withGamma(*golden, 0.97)},
                                                     {"nothing", blank(*golden)},
                                                     {"an object less", withoutAnObject(*golden)},
                                                     {"a scratch", withAScratch(*golden)},
                                                     {"another size", Picture(golden->width, 10)}};
    for (const auto& [what, picture] : wrong)
      EXPECT_NE(test::differs(*golden, picture), "") << name << ": " << what;
  }
}

TEST(WindowGolden, NothingToSeeIsNoGolden) {
  ::testing::TestPartResultArray failures;
  {
    const ::testing::ScopedFakeTestPartResultReporter caught(&failures);
    test::expectNotTrivial(Picture(640, 400));
  }
  EXPECT_EQ(failures.size(), 2);
}

}  // namespace
}  // namespace vernier::ui
