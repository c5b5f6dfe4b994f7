// SPDX-License-Identifier: GPL-3.0-or-later
// The window as a person uses it: opened on a study, scrolled, windowed, undone.
#include <gtest/gtest.h>

#include "RunProgram.h"
#include "TestData.h"
#include "WindowDriver.h"
#include "vernier/picture/Png.h"

namespace vernier::ui {
namespace {

using test::WindowDriver;

std::string smallStudy(const vernier::test::TempDir& dir) {
  const auto run = vernier::test::runProgram(
      {VERNIER_PROGRAM, "phantom", "small-ct", "--out", (dir.path() / "study").string()}, 60);
  EXPECT_EQ(run.exitCode, 0) << run.err;
  return (dir.path() / "study" / "small-ct").string();
}

// The middle of the picture in a window of 1280 x 800 with the list of studies.
constexpr double kX = 780, kY = 420;

// The window without its row of buttons: after an undo, Redo is bright.
std::vector<std::uint8_t> belowTools(const Picture& p) {
  constexpr int kTools_px = 45;
  const std::size_t row = p.pixels.size() / static_cast<std::size_t>(p.height);
  return {p.pixels.begin() + static_cast<std::ptrdiff_t>(kTools_px * row), p.pixels.end()};
}

TEST(Window, OpensScrollsWindowsAndUndoes) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  w.open(smallStudy(dir));
  const Tile& tile = w.workspace().tile(0);
  ASSERT_EQ(tile.view, "stack");
  const std::int64_t middle = imageOf(tile.scene)->index;
  const Picture opened = w.screenshot();

  w.move(kX, kY);
  w.wheel(-1);
  EXPECT_EQ(imageOf(tile.scene)->index, middle + 1);
  w.wheel(3);
  EXPECT_EQ(imageOf(tile.scene)->index, middle - 2);

  ASSERT_TRUE(w.settle());
  const VoiWindow before = w.desk().tileView(0).picture->window;
  w.dragBy(kX, kY, 50, -25);
  const VoiWindow after = *imageOf(tile.scene)->window;
  EXPECT_NEAR(after.width, before.width * (1 + 50.0 / 500), 1e-9);
  EXPECT_NEAR(after.center, before.center - 25 * before.width / 500, 1e-9);

  w.key(GLFW_KEY_Z, true);
  EXPECT_FALSE(imageOf(tile.scene)->window);
  w.key(GLFW_KEY_Z, true);
  EXPECT_EQ(imageOf(tile.scene)->index, middle);
  w.move(1, 1);
  EXPECT_TRUE(belowTools(w.screenshot()) == belowTools(opened));
  w.key(GLFW_KEY_Y, true);
  EXPECT_EQ(imageOf(tile.scene)->index, middle - 2);
}

TEST(Window, MprCrosshairAndMaximise) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  w.open(smallStudy(dir));
  w.key(GLFW_KEY_F4);
  ASSERT_TRUE(w.settle());
  ASSERT_EQ(w.workspace().shown().size(), 4u);
  for (int t = 0; t < 4; ++t) {
    ASSERT_TRUE(w.desk().tileView(t).picture);
    EXPECT_FALSE(w.desk().tileView(t).picture->error);
    EXPECT_TRUE(w.desk().tileView(t).picture->measured);
  }
  const PatientPoint before = *w.workspace().crosshair(0);
  w.key(GLFW_KEY_C);
  w.dragBy(500, 250, 20, 10);
  const PatientPoint after = *w.workspace().crosshair(0);
  EXPECT_GT(length(after - before), 0.1);
  for (int t = 0; t < 4; ++t) {
    const Plane& plane = sliceOf(w.workspace().tile(t).scene)->plane;
    EXPECT_NEAR(dot(after - plane.point, normalize(plane.normal)), 0, 1e-9);
  }
  w.doubleClick(500, 250);
  EXPECT_EQ(w.workspace().shown(), std::vector<int>{0});
  w.doubleClick(540, 280);
  EXPECT_EQ(w.workspace().shown().size(), 4u);
}

TEST(Window, WithoutADisplayItIsOneSentence) {
  const auto run = vernier::test::runProgram({VERNIER_PROGRAM, "view"}, 30, {"DISPLAY=", "WAYLAND_DISPLAY="});
  EXPECT_EQ(run.exitCode, exitCode(ErrorCode::WindowUnavailable));
  EXPECT_EQ(run.lines(run.err), 1) << run.err;
  EXPECT_NE(run.err.find("display"), std::string::npos) << run.err;
  const auto doctor =
      vernier::test::runProgram({VERNIER_PROGRAM, "doctor"}, 30, {"DISPLAY=", "WAYLAND_DISPLAY="});
  EXPECT_EQ(doctor.exitCode, 0);
  const std::string sentence = run.err.substr(run.err.find("window: ") + 8);
  EXPECT_NE(doctor.out.find(sentence.substr(0, sentence.size() - 1)), std::string::npos) << doctor.out;
}

}  // namespace
}  // namespace vernier::ui
