// SPDX-License-Identifier: GPL-3.0-or-later
// The window as a person uses it: opened on a study, scrolled, windowed, undone.
#include <gtest/gtest.h>

#include "Golden.h"
#include "WindowDriver.h"
#include "WindowStudies.h"

namespace vernier::ui {
namespace {

using test::smallStudy;
using test::volumeFile;
using test::WindowDriver;

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
  w.doubleClick(460, 300);  // not where the drag began, whose press would count as the first click
  EXPECT_EQ(w.workspace().shown(), std::vector<int>{0});
  w.doubleClick(540, 280);
  EXPECT_EQ(w.workspace().shown().size(), 4u);
  EXPECT_NEAR(length(*w.workspace().crosshair(0) - after), 0, 1e-9);  // a double click moves nothing
  w.click(560, 300);
  EXPECT_GT(length(*w.workspace().crosshair(0) - after), 0.1);
}

// The same hands on a real head: no golden, since real pictures stay out of the repository.
TEST(Window, ARealStudy) {
  VERNIER_NEEDS_DATA("ct_phantom_head_series");
  WindowDriver w;
  if (!w.here()) return;
  w.open((vernier::test::dataDir() / "ct_phantom_head_series").string());
  EXPECT_TRUE(w.desk().messages().empty());
  const Arrangement opened = w.workspace().now();
  w.move(kX, kY);
  w.wheel(-3);
  ASSERT_TRUE(w.settle());
  w.dragBy(kX, kY, 80, 40);
  w.key(GLFW_KEY_F4);
  w.key(GLFW_KEY_C);
  ASSERT_TRUE(w.settle());
  w.dragBy(500, 250, 20, 10);
  w.doubleClick(1030, 280);
  EXPECT_EQ(w.workspace().shown(), std::vector<int>{1});
  w.doubleClick(700, 300);
  test::expectNotTrivial(w.screenshot());
  for (int t = 0; t < 4; ++t) {
    const auto& picture = w.desk().tileView(t).picture;
    ASSERT_TRUE(picture && !picture->error && picture->measured) << t;
  }
  for (int k = 0; k < 10; ++k) w.key(GLFW_KEY_Z, true);
  EXPECT_FALSE(w.workspace().canUndo());
  EXPECT_EQ(w.workspace().now().tiles, opened.tiles);
}

TEST(Window, SeveralVolumeFilesAtOnce) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  w.open({volumeFile(dir, "first"), volumeFile(dir, "second"), smallStudy(dir)});
  EXPECT_TRUE(w.desk().messages().empty());
  ASSERT_EQ(w.desk().documents().size(), 1u);
  const Document& d = *w.desk().documents()[0];
  ASSERT_EQ(d.session->volumeFiles().size(), 2u);
  for (const std::size_t v : {0u, 1u}) {
    const SourceId source{d.number, d.session->sourceName({0, 0, v})};
    w.desk().openSource(source, 0);
    ASSERT_TRUE(w.settle());
    const auto& picture = w.desk().tileView(0).picture;
    ASSERT_TRUE(picture && !picture->error);
    EXPECT_EQ(w.workspace().tile(0).source, source);
    EXPECT_EQ(picture->volume->grid().columns, 24);
    EXPECT_TRUE(d.thumbnails.contains(source));
  }
}

// Inverted pixels are 255 minus what they were, whatever else was changed since.
TEST(Window, AnInversionStays) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  w.open(smallStudy(dir));
  const auto centre = [&] {
    EXPECT_TRUE(w.settle());
    const Picture& p = w.desk().tileView(0).picture->rgba;
    return static_cast<int>(*p.at(p.width / 2 + 40, p.height / 2));
  };
  const auto edits = {
      +[](WindowDriver& d) { d.dragBy(kX, kY, 120, 60); }, +[](WindowDriver& d) { d.wheel(-1); },
      +[](WindowDriver& d) { d.key(GLFW_KEY_5); },         +[](WindowDriver& d) { d.key(GLFW_KEY_F4); },
      +[](WindowDriver& d) { d.key(GLFW_KEY_DOWN); },      +[](WindowDriver& d) { d.key(GLFW_KEY_F2); },
      +[](WindowDriver& d) { d.key(GLFW_KEY_0); }};
  int informative = 0;
  for (const auto& edit : edits) {
    edit(w);
    const int plain = centre();
    w.key(GLFW_KEY_I);
    EXPECT_NEAR(centre(), 255 - plain, 1);
    w.key(GLFW_KEY_I);
    informative += std::abs(plain - 127) > 20;
  }
  EXPECT_GE(informative, 5);
  w.key(GLFW_KEY_I);
  for (const auto& edit : edits) edit(w);
  EXPECT_TRUE(imageOf(w.workspace().tile(0).scene)->invert);
}

// The loop draws what was finished last, although no event follows.
TEST(Window, ThePictureFinishedLastIsOnTheScreen) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  w.open(smallStudy(dir));
  w.move(kX, kY);
  for (int round = 0; round < 3; ++round) {
    InputEvent notch;
    notch.kind = InputEvent::Kind::Wheel, notch.y = -1;
    for (int k = 0; k < 3; ++k) w.host().add(notch);
    w.runUntilIdleFor(0.6);
    const Picture seen = w.host().screenshot();
    w.host().frame();
    EXPECT_TRUE(seen.pixels == w.host().screenshot().pixels) << "round " << round;
  }
}

TEST(Window, CtrlQQuitsEvenWhileTyping) {
  WindowDriver w;
  if (!w.here()) return;
  w.click(120, 64);  // the field for a path
  w.host().frame();
  ASSERT_TRUE(ImGui::GetIO().WantTextInput);
  w.key(GLFW_KEY_Q);
  EXPECT_FALSE(w.host().gui().wantsToQuit());
  w.key(GLFW_KEY_Q, true);
  EXPECT_TRUE(w.host().gui().wantsToQuit());
}

TEST(Window, AMistypedNameIsToldBeforeTheWindow) {
  const auto run = vernier::test::runProgram({VERNIER_PROGRAM, "view", "/no/such-study"}, 30,
                                             {"DISPLAY=", "WAYLAND_DISPLAY="});
  EXPECT_EQ(run.exitCode, exitCode(ErrorCode::FileNotFound));
  EXPECT_EQ(run.lines(run.err), 1) << run.err;
  EXPECT_NE(run.err.find("such-study: There is no such file"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace vernier::ui
