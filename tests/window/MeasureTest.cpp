// SPDX-License-Identifier: GPL-3.0-or-later
// Measuring in the real window: a key, the points, and back to windowing.
#include <gtest/gtest.h>

#include "Golden.h"
#include "Measuring.h"
#include "WindowDriver.h"
#include "WindowStudies.h"
#include "vernier/measure/MeasurementJson.h"

namespace vernier::ui {
namespace {

using test::WindowDriver;

constexpr double kX = 780, kY = 420;

const Drawn& last(WindowDriver& w) { return w.workspace().now().measurements.back(); }
measure::Measured saidOf(WindowDriver& w, const Drawn& d) {
  const auto* r = w.desk().said(d);
  EXPECT_TRUE(r && *r) << (r ? r->error().text() : "its volume is not there");
  return r && *r ? **r : measure::Measured{};
}

TEST(WindowMeasure, ALengthByOneKeyAndOneDragThenWindowingAgain) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  const Place place = *w.desk().tileView(0).place;
  w.key(GLFW_KEY_L);
  w.dragBy(kX - 60, kY - 40, 90, 40);
  ASSERT_EQ(w.workspace().now().measurements.size(), 1u);
  const measure::Quantity q = saidOf(w, last(w)).quantities.at(0);
  EXPECT_NEAR(q.value, std::hypot(90, 40) * place.unit_mm, 1e-6);
  EXPECT_EQ(q.unit, "mm");
  EXPECT_GT(*q.expanded, 0);
  // Used once: the next drag windows.
  w.dragBy(kX + 200, kY + 250, 50, -25);
  EXPECT_EQ(w.workspace().now().measurements.size(), 1u);
  EXPECT_TRUE(imageOf(w.workspace().tile(0).scene)->window);
  // On the next image it is not shown, and a drag there takes no handle.
  w.wheel(-1);
  ASSERT_TRUE(w.settle());
  const Drawn before = last(w);
  w.dragBy(kX + 30, kY, 20, 0);
  EXPECT_TRUE(last(w) == before);
  w.key(GLFW_KEY_Z, true);  // the window
  w.key(GLFW_KEY_Z, true);  // the scroll
  w.key(GLFW_KEY_Z, true);  // the window
  ASSERT_TRUE(w.settle());
  // Its end is a handle.
  w.dragBy(kX + 30, kY, 20, 10);
  EXPECT_NEAR(saidOf(w, last(w)).quantities.at(0).value, std::hypot(110, 50) * place.unit_mm, 1e-6);
  w.key(GLFW_KEY_Z, true);
  EXPECT_NEAR(saidOf(w, last(w)).quantities.at(0).value, std::hypot(90, 40) * place.unit_mm, 1e-6);
  w.key(GLFW_KEY_Z, true);
  EXPECT_TRUE(w.workspace().now().measurements.empty());
  w.key(GLFW_KEY_Y, true);
  EXPECT_EQ(w.workspace().now().measurements.size(), 1u);
  w.key(GLFW_KEY_DELETE);
  EXPECT_TRUE(w.workspace().now().measurements.empty());
}

// At every place the value is the stored pixel that the status line names.
TEST(WindowMeasure, AValueIsThePixelUnderThePointer) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  const TileView& tile = w.desk().tileView(0);
  const SourceFacts& facts = *w.workspace().factsOfTile(0);
  // Where the picture lies in the window: 26 px below the tile, beside the list of studies.
  const double left = 1280 - tile.view.width_px, top = 800 - 28 - tile.view.height_px;
  for (int n = 0; n < 12; ++n) {
    const double x = 640 + 23 * n, y = 300 + 17 * n;
    w.key(GLFW_KEY_V);
    w.click(x, y);
    ASSERT_EQ(w.workspace().now().measurements.size(), static_cast<std::size_t>(n + 1));
    const Probe there = probeImage(*tile.place, *tile.picture->frame, facts, {x - left + 0.5, y - top + 0.5});
    const measure::Measured m = saidOf(w, last(w));
    const std::string stored = "stored " + measure::displayText({"", m.quantities.at(1).value, "1", {}});
    EXPECT_EQ(there.origin.substr(0, stored.size()), stored) << there.origin;
  }
}

TEST(WindowMeasure, EveryToolOnReformatsWithItsList) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  w.key(GLFW_KEY_F4);
  w.key(GLFW_KEY_1);
  ASSERT_TRUE(w.settle());
  w.key(GLFW_KEY_A);
  w.click(480, 180);
  w.click(540, 250);
  w.click(600, 200);
  w.key(GLFW_KEY_E);
  w.dragBy(980, 200, 60, 50);
  w.key(GLFW_KEY_B);
  w.click(470, 560);
  w.click(530, 600);
  w.key(GLFW_KEY_V);
  w.click(1040, 560);
  w.key(GLFW_KEY_N);
  w.dragBy(560, 640, 40, 30);
  w.key(GLFW_KEY_L);
  w.key(GLFW_KEY_ESCAPE);  // not this one
  w.dragBy(600, 280, 0, 0);
  const auto& all = w.workspace().now().measurements;
  ASSERT_EQ(all.size(), 5u);
  const std::vector<std::string> kinds{"angle", "ellipse", "rectangle", "probe", "arrow"};
  for (std::size_t n = 0; n < all.size(); ++n) {
    EXPECT_EQ(measure::kindOf(all[n].what.shape), kinds[n]);
    EXPECT_EQ(all[n].what.on.space, measure::Space::Patient);
    saidOf(w, all[n]);
  }
  const glm::dvec2 a(-60, -70), b(60, -50);
  EXPECT_NEAR(saidOf(w, all[0]).quantities[0].value,
              std::acos(glm::dot(a, b) / glm::length(a) / glm::length(b)) * 180 / 3.14159265358979, 1e-6);
  const double mm = w.desk().tileView(1).place->unit_mm;
  EXPECT_NEAR(saidOf(w, all[1]).quantities[0].value, 3.14159265358979 / 4 * 60 * 50 * mm * mm, 1e-6);
  EXPECT_TRUE(saidOf(w, all[1]).values);
  w.key(GLFW_KEY_M);
  w.move(2, 2);
  test::expectNotTrivial(w.screenshot());

  // Saved and loaded they say the same.
  const std::string file = (dir.path() / "list.json").string();
  ASSERT_TRUE(w.desk().saveMeasurements(1, file).ok() || w.desk().saveMeasurements(0, file).ok());
  const int document = all[0].document;
  std::vector<measure::Measured> before;
  for (const Drawn& d : all) before.push_back(saidOf(w, d));
  ASSERT_TRUE(w.desk().loadMeasurements(document, file).ok());
  ASSERT_EQ(w.workspace().now().measurements.size(), 10u);
  for (std::size_t n = 0; n < 5; ++n)
    EXPECT_TRUE(saidOf(w, w.workspace().now().measurements[5 + n]) == before[n]) << n;
  w.key(GLFW_KEY_Z, true);
  EXPECT_EQ(w.workspace().now().measurements.size(), 5u) << "loading is one step";
  EXPECT_FALSE(w.desk().saveMeasurements(document, dir.path() / "none/list.json").ok());
  EXPECT_FALSE(w.desk().loadMeasurements(document, dir.path() / "none.json").ok());
}

// The same length on the same place, at another scale of the screen: the value stays, and so does its text.
TEST(WindowMeasure, AnotherScaleOfTheScreenSaysTheSame) {
  vernier::test::TempDir dir;
  const std::string study = test::headStudy(dir);
  const std::string file = (dir.path() / "list.json").string();
  std::vector<std::string> texts;
  for (const float scale : {1.0f, 2.0f}) {
    HostOptions options;
    options.scale = scale;
    options.width = 1000, options.height = 700;
    WindowDriver w(options);
    if (!w.here()) return;
    w.open(study);
    ASSERT_TRUE(w.settle());
    const int document = w.workspace().tile(0).source.document;
    if (scale == 1) {
      w.key(GLFW_KEY_L);
      w.dragBy(600, 300, 90, 40);
      ASSERT_TRUE(w.desk().saveMeasurements(document, file).ok());
    } else {
      ASSERT_TRUE(w.desk().loadMeasurements(document, file).ok());
    }
    ASSERT_EQ(w.workspace().now().measurements.size(), 1u);
    texts.push_back(measure::displayText(saidOf(w, last(w)).quantities.at(0)));
  }
  EXPECT_EQ(texts.at(0), texts.at(1));
}

}  // namespace
}  // namespace vernier::ui
