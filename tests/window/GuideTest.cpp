// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of docs/guide.md, done on the real window: its pictures are goldens, so the guide shows the
// window as it is.
#include <gtest/gtest.h>

#include <cmath>

#include "Golden.h"
#include "WindowDriver.h"
#include "WindowStudies.h"

namespace vernier::ui {
namespace {

void expectPicture(const char* name, test::WindowDriver& w) {
  test::expectGolden(name, w.screenshot(), "docs");
}

// Cobb angle, diameters, polygon, outline by hand and words.
void moreTools(test::WindowDriver& w) {
  w.key(GLFW_KEY_Y);
  w.dragBy(500, 255, 120, -30);
  w.dragBy(510, 300, 115, 25);
  w.key(GLFW_KEY_D);
  w.dragBy(600, 500, -35, 62);
  w.dragBy(570, 520, 24, 14);
  w.key(GLFW_KEY_O);
  for (const auto& [x, y] : {std::pair{690, 350}, {745, 355}, {770, 410}, {745, 455}, {700, 440}})
    w.click(x, y);
  w.key(GLFW_KEY_ENTER);
  w.key(GLFW_KEY_H);
  w.move(534, 551);
  w.button(0, true);
  for (int n = 0; n <= 48; ++n) w.move(512 + 22 * std::cos(n * 0.1309), 551 + 26 * std::sin(n * 0.1309));
  w.button(0, false);
  w.key(GLFW_KEY_X);
  w.click(656, 500);
  ASSERT_TRUE(w.settle());
  w.type("calcified pineal");
  w.key(GLFW_KEY_ENTER);
  w.move(2, 2);
  ASSERT_TRUE(w.settle());
}

// A surface that is turned, cut open by a lens, and the point that was clicked in the slices beside it.
// Surfaces are exact however slow the machine is; of renderings the error that stands on the picture depends
// on the time.
void throughTheVolume(test::WindowDriver& w) {
  w.key(GLFW_KEY_F5);
  ASSERT_TRUE(w.settle());
  w.key(GLFW_KEY_W);
  w.key(GLFW_KEY_8);
  w.dragBy(1030, 600, 70, 30);
  w.move(1060, 540);
  ASSERT_TRUE(w.settle());  // the lens goes about the point that is seen
  w.key(GLFW_KEY_G);
  ASSERT_TRUE(w.settle());
  w.hold(GLFW_KEY_LEFT_CONTROL, true);
  w.click(1102, 632);
  w.hold(GLFW_KEY_LEFT_CONTROL, false);
  w.move(2, 2);
  test::expectGolden("guide-3d", w.screenshot(), "docs", 255);
}

TEST(Guide, ItsPicturesAreOfThisWindow) {
  vernier::test::TempDir dir;
  test::WindowDriver w;
  if (!w.here()) return;
  w.open(test::study(dir, "ct-head", {"--set", "scale=0.5"}));
  w.move(690, 330);  // a value under the pointer
  expectPicture("guide-open", w);

  w.wheel(-12);
  w.key(GLFW_KEY_4);  // bone
  ASSERT_TRUE(w.settle());
  w.dragBy(690, 330, 100, 20);
  expectPicture("guide-window", w);

  w.key(GLFW_KEY_1);  // brain
  w.key(GLFW_KEY_M);  // the list first: it makes room, and pictures change their size
  ASSERT_TRUE(w.settle());
  w.key(GLFW_KEY_L);
  w.dragBy(560, 330, 160, -60);
  w.key(GLFW_KEY_A);
  for (const auto& [x, y] : {std::pair{560, 520}, {650, 440}, {760, 500}}) w.click(x, y);
  w.key(GLFW_KEY_E);
  w.dragBy(600, 340, 90, 60);
  w.move(2, 2);
  expectPicture("guide-measure", w);
  for (int n = 0; n < 3; ++n) w.key(GLFW_KEY_Z, true);
  moreTools(w);
  expectPicture("guide-tools", w);
  w.key(GLFW_KEY_M);
  for (int n = 0; n < 5; ++n) w.key(GLFW_KEY_Z, true);

  w.key(GLFW_KEY_F4);
  ASSERT_TRUE(w.settle());
  w.key(GLFW_KEY_C);
  w.dragBy(541, 241, -27, 27);
  expectPicture("guide-mpr", w);

  w.move(2, 2);
  w.key(GLFW_KEY_F1);
  expectPicture("guide-help", w);
  w.key(GLFW_KEY_F1);

  w.move(600, 330);
  w.key(GLFW_KEY_G);  // a lens
  ASSERT_TRUE(w.settle());
  w.key(GLFW_KEY_E);
  w.dragBy(960, 130, 70, 50);  // across the slices
  w.move(2, 2);
  expectPicture("guide-lens", w);
  for (int n = 0; n < 2; ++n) w.key(GLFW_KEY_Z, true);
  throughTheVolume(w);
}

// The same head in two resolutions, side by side.
TEST(Guide, ItsPicturesOfComparingAreOfThisWindow) {
  vernier::test::TempDir fine, coarse;
  test::WindowDriver w;
  if (!w.here()) return;
  w.open(test::study(fine, "ct-head", {"--set", "scale=0.5"}));
  w.key(GLFW_KEY_F3);
  w.click(1030, 420);  // the empty one: what is opened now goes there
  w.open(test::headStudy(coarse));
  w.key(GLFW_KEY_1);
  w.move(1030, 400);
  w.wheel(-6);
  w.click(550, 400);
  w.key(GLFW_KEY_1);
  w.wheel(-12);
  w.key(GLFW_KEY_T);
  w.move(2, 2);
  ASSERT_FALSE(w.workspace().differentPeople());
  expectPicture("guide-together", w);
  w.key(GLFW_KEY_K);
  w.move(560, 330);
  expectPicture("guide-wipe", w);
}

}  // namespace
}  // namespace vernier::ui
