// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of docs/guide.md, done on the real window: its pictures are goldens, so the guide shows the
// window as it is.
#include <gtest/gtest.h>

#include "Golden.h"
#include "WindowDriver.h"
#include "WindowStudies.h"

namespace vernier::ui {
namespace {

void expectPicture(const char* name, test::WindowDriver& w) {
  test::expectGolden(name, w.screenshot(), "docs");
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
  w.key(GLFW_KEY_M);
  for (int n = 0; n < 3; ++n) w.key(GLFW_KEY_Z, true);

  w.key(GLFW_KEY_F4);
  ASSERT_TRUE(w.settle());
  w.key(GLFW_KEY_C);
  w.dragBy(541, 241, -27, 27);
  expectPicture("guide-mpr", w);

  w.move(2, 2);
  w.key(GLFW_KEY_F1);
  expectPicture("guide-help", w);
}

}  // namespace
}  // namespace vernier::ui
