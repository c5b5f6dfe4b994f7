// SPDX-License-Identifier: GPL-3.0-or-later
// Two pictures side by side: scrolled together, laid on each other by wipe and flicker.
#include <gtest/gtest.h>

#include <algorithm>

#include "WindowDriver.h"
#include "WindowStudies.h"

namespace vernier::ui {
namespace {

constexpr int kGap = 2;

struct Pair {
  explicit Pair(test::WindowDriver& driver) : w(driver) {
    w.key(GLFW_KEY_B, true);  // the pictures have the whole width
    w.key(GLFW_KEY_F3);
    w.desk().openSource(w.workspace().tile(0).source, 1);
    EXPECT_TRUE(w.settle());
    const Picture whole = w.screenshot();
    tile = (whole.width - kGap) / 2;
    middle = whole.height / 2 + 40;
  }
  // The row of pixels in the middle of tile t, without its border.
  std::vector<std::uint8_t> row(const Picture& p, int t, double from, double to) const {
    const int x0 = t * (tile + kGap);
    const int a = x0 + std::max(2, static_cast<int>(from * tile)),
              b = x0 + std::min(tile - 2, static_cast<int>(to * tile));
    std::vector<std::uint8_t> out;
    for (int x = a; x < b; ++x) out.push_back(p.at(x, middle)[0]);
    return out;
  }
  test::WindowDriver& w;
  int tile = 0, middle = 0;
};

TEST(SideBySide, TogetherAndWipeAndFlicker) {
  vernier::test::TempDir dir;
  test::WindowDriver w;
  if (!w.here()) return;
  w.open(test::headStudy(dir));
  Pair pair(w);
  w.move(pair.tile * 1.5, pair.middle);
  w.wheel(-9);  // the right one shows another slice
  w.move(1, 1);
  ASSERT_TRUE(w.settle());
  const Picture apart = w.screenshot();
  ASSERT_NE(pair.row(apart, 0, 0, 1), pair.row(apart, 1, 0, 1)) << "two different slices";

  w.key(GLFW_KEY_K);
  w.move(pair.tile * 0.5, pair.middle);
  ASSERT_TRUE(w.settle());
  const Picture wiped = w.screenshot();
  for (const int t : {0, 1}) {
    EXPECT_EQ(pair.row(wiped, t, 0, 0.48), pair.row(apart, 0, 0, 0.48)) << t;
    EXPECT_EQ(pair.row(wiped, t, 0.52, 1), pair.row(apart, 1, 0.52, 1)) << t;
  }
  w.key(GLFW_KEY_K);
  w.move(1, 1);
  ASSERT_TRUE(w.settle());
  EXPECT_EQ(pair.row(w.screenshot(), 0, 0, 1), pair.row(apart, 0, 0, 1));

  w.hold(GLFW_KEY_F, true);
  ASSERT_TRUE(w.settle());
  const Picture flicker = w.screenshot();
  EXPECT_EQ(pair.row(flicker, 0, 0, 1), pair.row(apart, 1, 0, 1));
  EXPECT_EQ(pair.row(flicker, 1, 0, 1), pair.row(apart, 0, 0, 1));
  w.hold(GLFW_KEY_F, false);
  ASSERT_TRUE(w.settle());
  EXPECT_EQ(pair.row(w.screenshot(), 0, 0, 1), pair.row(apart, 0, 0, 1));

  w.key(GLFW_KEY_T);
  w.move(pair.tile * 0.5, pair.middle);
  w.wheel(-2);
  ASSERT_TRUE(w.settle());
  EXPECT_TRUE(w.workspace().now().together);
  EXPECT_FALSE(w.workspace().togetherIsManual());
  EXPECT_EQ(imageOf(w.workspace().tile(0).scene)->index, imageOf(w.workspace().tile(1).scene)->index);
  const Picture same = w.screenshot();
  EXPECT_EQ(pair.row(same, 0, 0, 1), pair.row(same, 1, 0, 1));
}

}  // namespace
}  // namespace vernier::ui
