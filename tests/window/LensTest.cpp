// SPDX-License-Identifier: GPL-3.0-or-later
// A lens on slices in the real window: placed by a key, moved, scaled and removed by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "Lenses.h"
#include "WindowDriver.h"
#include "WindowStudies.h"

namespace vernier::ui {
namespace {

using test::WindowDriver;

constexpr double kX = 541, kY = 241;  // in the axial picture

LensDisc discIn(WindowDriver& w, int t, std::size_t lens = 0) {
  const auto d = discOf(w.workspace().now().lenses.at(lens).layer, *w.desk().tileView(t).place);
  EXPECT_TRUE(d) << "tile " << t << " does not cut it";
  return d.value_or(LensDisc{});
}
// Where the axial picture lies in the window.
glm::dvec2 corner(WindowDriver& w) {
  const View& v = w.desk().tileView(0).view;
  const double width = 2 * v.width_px + 2, height = 2 * (v.height_px + 26) + 2;
  return {1280 - width, 800 - 28 - height + 26};
}
// Pixels of the axial picture from the disc's centre to `to_px`, above and below the crosshair's lines.
std::vector<int> along(WindowDriver& w, const Picture& p, const LensDisc& d, double from_px, double to_px) {
  std::vector<int> all;
  for (const double a : {0.7, 2.4, 3.9, 5.5})
    for (double r = from_px; r < to_px; r += 3) {
      const glm::dvec2 at = corner(w) + d.centre_px + r * glm::dvec2(std::cos(a), std::sin(a));
      all.push_back(p.at(static_cast<int>(at.x), static_cast<int>(at.y))[0]);
    }
  return all;
}

TEST(WindowLens, AKeyPlacesItAndHandsMoveScaleAndRemoveIt) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  w.move(kX, kY);
  w.key(GLFW_KEY_G);
  EXPECT_NE(w.host().gui().why().find("MPR (F4)"), std::string::npos) << "not on stored frames";
  EXPECT_TRUE(w.workspace().now().lenses.empty());
  w.key(GLFW_KEY_F4);
  w.key(GLFW_KEY_4);  // bone
  w.move(2, 2);
  const Picture bone = w.screenshot();
  w.key(GLFW_KEY_1);  // brain
  const Picture brain = w.screenshot();

  w.move(kX, kY);
  w.key(GLFW_KEY_G);
  ASSERT_EQ(w.workspace().now().lenses.size(), 1u);
  EXPECT_TRUE(w.host().gui().why().empty());
  w.move(2, 2);
  const Picture lens = w.screenshot();
  const LensDisc d = discIn(w, 0);
  EXPECT_LT(glm::length(corner(w) + d.centre_px - glm::dvec2(kX + 0.5, kY + 0.5)), 1e-6) << "at the pointer";
  for (const int t : {1, 2, 3}) EXPECT_GT(discIn(w, t).radius_px, 5) << "in the linked pictures, too";
  // Inside is the bone window, outside the brain window, pixel by pixel.
  EXPECT_NE(along(w, bone, d, 14, d.radius_px - 4), along(w, brain, d, 14, d.radius_px - 4));
  EXPECT_EQ(along(w, lens, d, 14, d.radius_px - 4), along(w, bone, d, 14, d.radius_px - 4));
  const double out = d.radius_px + 30;  // below the outline stands what is seen inside
  EXPECT_EQ(along(w, lens, d, out, out + 60), along(w, brain, d, out, out + 60));
  EXPECT_NE(along(w, lens, d, d.radius_px - 1, d.radius_px + 1.5),
            along(w, brain, d, d.radius_px - 1, d.radius_px + 1.5))
      << "its outline";

  // Its inside moves it, without a change of the window.
  const auto window = sliceOf(w.workspace().tile(0).scene)->window;
  w.dragBy(kX, kY, 40, -25);
  EXPECT_EQ(sliceOf(w.workspace().tile(0).scene)->window, window);
  ASSERT_TRUE(w.settle());
  EXPECT_LT(glm::length(discIn(w, 0).centre_px - d.centre_px - glm::dvec2(40, -25)), 1e-6);
  EXPECT_NEAR(discIn(w, 0).radius_px, d.radius_px, 1e-6);
  // Its outline scales it; the middle stays.
  w.dragBy(kX + 40 + std::round(d.radius_px), kY - 25, 20, 0);
  ASSERT_TRUE(w.settle());
  EXPECT_NEAR(discIn(w, 0).radius_px, d.radius_px + 20, 1e-6);
  EXPECT_LT(glm::length(discIn(w, 0).centre_px - d.centre_px - glm::dvec2(40, -25)), 1e-6);
  // Ctrl + wheel, too; the wheel alone scrolls.
  const Plane plane = sliceOf(w.workspace().tile(0).scene)->plane;
  w.move(kX + 40, kY - 25);
  w.hold(GLFW_KEY_LEFT_CONTROL, true);
  w.wheel(2);
  w.hold(GLFW_KEY_LEFT_CONTROL, false);
  ASSERT_TRUE(w.settle());
  EXPECT_NEAR(discIn(w, 0).radius_px, (d.radius_px + 20) * 1.21, 1e-3);
  EXPECT_EQ(sliceOf(w.workspace().tile(0).scene)->plane, plane);
  w.wheel(1);
  ASSERT_TRUE(w.settle());
  EXPECT_NE(sliceOf(w.workspace().tile(0).scene)->plane, plane);
  EXPECT_LT(discIn(w, 0).radius_px, (d.radius_px + 20) * 1.21 - 1e-3) << "a slice further it is smaller";
  w.key(GLFW_KEY_Z, true);
  // The key again: the next look; outside of it the left button windows.
  w.key(GLFW_KEY_G);
  ASSERT_EQ(w.workspace().now().lenses.size(), 1u);
  EXPECT_EQ(w.workspace().now().lenses[0].look, "Lung");
  w.dragBy(kX - 150, kY + 100, 30, 0);
  EXPECT_NE(sliceOf(w.workspace().tile(0).scene)->window, window);
  w.key(GLFW_KEY_DELETE);
  EXPECT_TRUE(w.workspace().now().lenses.empty());
  // Undo: Del, window, look, wheel, outline, move, placing.
  for (int n = 0; n < 6; ++n) w.key(GLFW_KEY_Z, true);
  ASSERT_TRUE(w.settle());
  ASSERT_EQ(w.workspace().now().lenses.size(), 1u);
  EXPECT_LT(glm::length(discIn(w, 0).centre_px - d.centre_px), 1e-6);
  EXPECT_NEAR(discIn(w, 0).radius_px, d.radius_px, 1e-6);
  w.key(GLFW_KEY_Z, true);
  EXPECT_TRUE(w.workspace().now().lenses.empty());
  w.move(2, 2);
  const Picture again = w.screenshot();
  EXPECT_EQ(along(w, again, d, 14, out + 60), along(w, brain, d, 14, out + 60));
}

TEST(WindowLens, TheMenuPlacesItInTheMiddle) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  w.key(GLFW_KEY_F4);
  ASSERT_TRUE(w.settle());
  w.click(1140, 20);  // Measure
  ASSERT_TRUE(w.settle());
  for (double y = 270; y < 340 && w.workspace().now().lenses.empty(); y += 8) {  // down the list to it
    w.move(1120, y);
    ASSERT_TRUE(w.settle());
    w.click(1120, y);
    ASSERT_TRUE(w.settle());
    if (w.host().gui().ruler()) {  // that was a tool
      w.key(GLFW_KEY_ESCAPE);
      w.click(1140, 20);
      ASSERT_TRUE(w.settle());
    }
  }
  ASSERT_EQ(w.workspace().now().lenses.size(), 1u);
  const View& v = w.desk().tileView(0).view;
  EXPECT_LT(glm::length(discIn(w, 0).centre_px - 0.5 * glm::dvec2(v.width_px, v.height_px)), 1e-6);
}

// What was chosen last is what Del takes away.
TEST(WindowLens, DelTakesTheChosenOneOfLensAndMeasurement) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  w.key(GLFW_KEY_F4);
  ASSERT_TRUE(w.settle());
  w.move(kX, kY);
  w.key(GLFW_KEY_G);
  w.key(GLFW_KEY_L);
  w.dragBy(kX - 150, kY, 60, 0);
  w.key(GLFW_KEY_DELETE);
  EXPECT_TRUE(w.workspace().now().measurements.empty());
  EXPECT_EQ(w.workspace().now().lenses.size(), 1u);
  w.key(GLFW_KEY_L);
  w.dragBy(kX - 150, kY, 60, 0);
  w.click(kX, kY);  // the lens
  w.key(GLFW_KEY_DELETE);
  EXPECT_EQ(w.workspace().now().measurements.size(), 1u);
  EXPECT_TRUE(w.workspace().now().lenses.empty());
}

}  // namespace
}  // namespace vernier::ui
