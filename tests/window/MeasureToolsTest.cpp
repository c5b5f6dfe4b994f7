// SPDX-License-Identifier: GPL-3.0-or-later
// The measuring tools of more than two points, and words, in the real window; a region goes to the acquired
// slice by a click.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "Measuring.h"
#include "WindowDriver.h"
#include "WindowStudies.h"
#include "vernier/measure/Outline.h"

namespace vernier::ui {
namespace {

using test::WindowDriver;

constexpr double kX = 780, kY = 420, kDegrees = 180 / std::numbers::pi;

const std::vector<Drawn>& all(WindowDriver& w) { return w.workspace().now().measurements; }
measure::Measured saidOf(WindowDriver& w, const Drawn& d) {
  const auto* r = w.desk().said(d);
  EXPECT_TRUE(r && *r) << (r ? r->error().text() : "its volume is not there");
  return r && *r ? **r : measure::Measured{};
}
bool windows(WindowDriver& w) {  // the left button does it again
  const std::size_t before = all(w).size();
  const auto window = imageOf(w.workspace().tile(0).scene)->window;
  w.dragBy(kX + 200, kY + 250, 40, -20);
  const bool changed = imageOf(w.workspace().tile(0).scene)->window != window;
  w.key(GLFW_KEY_Z, true);
  return changed && all(w).size() == before;
}

TEST(WindowMeasureTools, CobbAngleAndDiameters) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  const double mm = w.desk().tileView(0).place->unit_mm;
  w.key(GLFW_KEY_Y);
  w.dragBy(kX - 80, kY - 60, 120, 20);  // one line by a drag, the other by two clicks
  EXPECT_TRUE(all(w).empty());
  w.click(kX - 70, kY + 60);
  w.click(kX + 50, kY + 20);
  ASSERT_EQ(all(w).size(), 1u);
  EXPECT_NEAR(saidOf(w, all(w)[0]).quantities.at(0).value,
              (std::atan2(20, 120) + std::atan2(40, 120)) * kDegrees, 1e-6);
  EXPECT_EQ(saidOf(w, all(w)[0]).quantities.at(0).unit, "deg");
  EXPECT_TRUE(windows(w));

  w.key(GLFW_KEY_D);
  w.dragBy(kX - 60, kY - 120, 100, 0);
  w.dragBy(kX - 20, kY - 150, 17, 70);  // what is not at right angles counts for nothing
  ASSERT_EQ(all(w).size(), 2u);
  const auto axes = [&] { return std::get<measure::Bidirectional>(all(w)[1].what.shape); };
  EXPECT_NEAR(axes().shortAxis[0].x, axes().shortAxis[1].x, 1e-9);
  measure::Measured m = saidOf(w, all(w)[1]);
  EXPECT_NEAR(m.quantities.at(0).value, 100 * mm, 1e-6);
  EXPECT_NEAR(m.quantities.at(1).value, 70 * mm, 1e-6);
  EXPECT_TRUE(windows(w));
  // A long short axis: when the hand lets go it is the long one. Undo takes the whole drag back.
  w.dragBy(kX - 20, kY - 80, 0, 80);
  m = saidOf(w, all(w)[1]);
  EXPECT_NEAR(m.quantities.at(0).value, 150 * mm, 1e-6);
  EXPECT_NEAR(m.quantities.at(1).value, 100 * mm, 1e-6);
  w.key(GLFW_KEY_Z, true);
  EXPECT_NEAR(saidOf(w, all(w)[1]).quantities.at(0).value, 100 * mm, 1e-6);
  w.key(GLFW_KEY_Z, true);
  w.key(GLFW_KEY_Z, true);
  EXPECT_TRUE(all(w).empty());
}

TEST(WindowMeasureTools, APolygonIsClosedInThreeWaysAndGivenUp) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  const double mm2 = std::pow(w.desk().tileView(0).place->unit_mm, 2);
  const std::vector<glm::dvec2> corners{{kX, kY}, {kX + 70, kY + 10}, {kX + 50, kY + 80}, {kX - 10, kY + 60}};
  const double area = measure::areaOf(corners) * mm2;
  for (const char* by : {"Enter", "its first corner", "double click"}) {
    const std::size_t before = all(w).size();
    w.key(GLFW_KEY_O);
    for (const glm::dvec2& p : corners) w.click(p.x, p.y);
    EXPECT_EQ(all(w).size(), before) << by;
    if (std::string(by) == "Enter") w.key(GLFW_KEY_ENTER);
    if (std::string(by) == "its first corner") w.click(kX + 2, kY + 2);
    if (std::string(by) == "double click") {
      ImGui::GetIO().MouseDoubleClickTime = 10;
      w.click(corners[3].x, corners[3].y);
    }
    ASSERT_EQ(all(w).size(), before + 1) << by;
    EXPECT_EQ(std::get<measure::PolygonRegion>(all(w).back().what.shape).corners.size(), 4u) << by;
    EXPECT_NEAR(saidOf(w, all(w).back()).quantities.at(0).value, area, 1e-6) << by;
    EXPECT_TRUE(saidOf(w, all(w).back()).values) << by;
    w.key(GLFW_KEY_Z, true);
    EXPECT_EQ(all(w).size(), before) << by;
  }
  EXPECT_EQ(w.workspace().shown().size(), 1u);
  w.key(GLFW_KEY_O);
  w.click(corners[0].x, corners[0].y);
  w.click(corners[1].x, corners[1].y);
  w.key(GLFW_KEY_ENTER);  // two corners enclose nothing: it goes on, and says so
  EXPECT_NE(w.host().gui().why().find("three corners"), std::string::npos) << w.host().gui().why();
  ASSERT_TRUE(w.host().gui().ruler());
  w.key(GLFW_KEY_ESCAPE);
  EXPECT_FALSE(w.host().gui().ruler());
  EXPECT_TRUE(w.host().gui().why().empty());
  EXPECT_TRUE(all(w).empty());
  EXPECT_TRUE(windows(w));
}

TEST(WindowMeasureTools, AnOutlineByHandKeepsItsWayHoweverSlowFramesAre) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  const double mm2 = std::pow(w.desk().tileView(0).place->unit_mm, 2);
  w.key(GLFW_KEY_H);
  w.click(kX, kY);  // no outline
  EXPECT_TRUE(all(w).empty());
  ASSERT_TRUE(w.host().gui().ruler());
  // A circle of 60 px in three frames: all that the pointer passed is kept.
  w.move(kX + 60, kY);
  w.button(0, true);
  for (int third = 0; third < 3; ++third) {
    for (int n = 0; n <= 60; ++n) {
      const double a = 2 * std::numbers::pi * (third * 60 + n) / 180;
      w.host().add({InputEvent::Kind::Pointer, kX + 60 * std::cos(a), kY + 60 * std::sin(a), 0, false, {}});
    }
    w.host().frame();
  }
  w.button(0, false);
  ASSERT_EQ(all(w).size(), 1u);
  EXPECT_GT(std::get<measure::FreehandRegion>(all(w)[0].what.shape).outline.size(), 100u);
  const measure::Measured m = saidOf(w, all(w)[0]);
  EXPECT_NEAR(m.quantities.at(0).value, std::numbers::pi * 60 * 60 * mm2, 0.01 * m.quantities.at(0).value);
  EXPECT_TRUE(windows(w));
  // Its first point is a grip.
  w.dragBy(kX + 60, kY, 30, 0);
  EXPECT_GT(saidOf(w, all(w)[0]).quantities.at(0).value, m.quantities.at(0).value + 100 * mm2);
  w.key(GLFW_KEY_Z, true);
  EXPECT_EQ(saidOf(w, all(w)[0]), m);
}

TEST(WindowMeasureTools, PointsOfOneMeasurementStandOnOneImage) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  w.key(GLFW_KEY_O);
  for (const double dx : {0.0, 50.0, 90.0}) w.click(kX + dx, kY + dx * dx / 100);
  w.wheel(-3);  // away: what was begun is left behind
  ASSERT_TRUE(w.settle());
  for (const double dx : {0.0, 50.0, 90.0}) w.click(kX + dx, kY - dx * dx / 100);
  w.key(GLFW_KEY_ENTER);
  ASSERT_EQ(all(w).size(), 1u);
  EXPECT_EQ(std::get<measure::PolygonRegion>(all(w)[0].what.shape).corners.size(), 3u);
  EXPECT_EQ(all(w)[0].what.on.frame, imageOf(w.workspace().tile(0).scene)->index);
}

TEST(WindowMeasureTools, WordsAreTypedWhereTheyStand) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  w.key(GLFW_KEY_X);
  w.click(kX, kY);
  EXPECT_TRUE(all(w).empty()) << "not without words";
  ASSERT_TRUE(w.settle());
  w.type("look, a L");  // no tools are taken by these
  w.key(GLFW_KEY_ENTER);
  ASSERT_TRUE(w.settle());
  ASSERT_EQ(all(w).size(), 1u);
  EXPECT_EQ(std::get<measure::Text>(all(w)[0].what.shape).text, "look, a L");
  EXPECT_TRUE(saidOf(w, all(w)[0]).quantities.empty());
  EXPECT_FALSE(w.host().gui().ruler());
  EXPECT_TRUE(windows(w));
  w.dragBy(kX, kY, 30, 10);
  EXPECT_NEAR(measure::handlesOf(all(w)[0].what.shape)[0].x -
                  spotAt(*w.desk().tileView(0).place, measure::Space::Image, {0, 0}).x,
              (kX + 30 - (1280 - w.desk().tileView(0).view.width_px) + 0.5) /
                  w.desk().tileView(0).place->image->pxPerColumn,
              1e-6);
  w.key(GLFW_KEY_X);
  w.click(kX + 60, kY);
  ASSERT_TRUE(w.settle());
  w.type("no");
  w.key(GLFW_KEY_ESCAPE);
  ASSERT_TRUE(w.settle());
  EXPECT_EQ(all(w).size(), 1u);
  w.key(GLFW_KEY_L);
  EXPECT_TRUE(w.host().gui().ruler()) << "keys are keys again";
}

// Statistics over a slice's voxels by their centres, one after the other.
TEST(WindowMeasureTools, ARegionOnAReformatGoesToStoredPixelsByAClick) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!test::openHead(dir, w)) return;
  w.key(GLFW_KEY_F4);
  ASSERT_TRUE(w.settle());
  w.key(GLFW_KEY_E);
  const double x = 1000, y = 230, width = 60, height = 45;
  w.dragBy(x, y, width, height);  // the coronal picture
  ASSERT_EQ(all(w).size(), 1u);
  const measure::Measured across = saidOf(w, all(w)[0]);
  EXPECT_EQ(across.notes.at(0), "interpolated");
  w.move(2, 2);
  ASSERT_TRUE(w.settle());
  // The offer stands below the two lines of the label, which stands beside the second corner.
  w.click(x + width + 9 + 20, y + height + 9 + 26 + 3 + 3 + 8);
  ASSERT_TRUE(w.settle());
  const measure::Measured there = saidOf(w, all(w)[0]);
  EXPECT_TRUE(std::find(there.notes.begin(), there.notes.end(), "interpolated") == there.notes.end());
  EXPECT_NEAR(there.quantities.at(0).value, across.quantities.at(0).value, 1e-6) << "the same size";
  EXPECT_EQ(w.workspace().tile(1).view, "axial");
  const auto volume = w.desk().document(all(w)[0].document)->session->readyVolume(all(w)[0].what.on.source);
  ASSERT_TRUE(volume);
  const auto corners = std::get<measure::EllipseRegion>(all(w)[0].what.shape).corners;
  const glm::dvec3 middle = 0.5 * (corners[0] + corners[1]), half = 0.5 * (corners[1] - corners[0]);
  const auto k = std::llround((volume->voxelFromPatient() * PatientPoint(middle)).p.z);
  double sum = 0, n = 0;
  for (std::int64_t j = 0; j < volume->grid().rows; ++j)
    for (std::int64_t i = 0; i < volume->grid().columns; ++i) {
      const glm::dvec3 d =
          (volume->grid().patientFromVoxel *
           VoxelPoint(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)))
              .p -
          middle;
      if (std::pow(d.x / half.x, 2) + std::pow(d.y / half.y, 2) > 1) continue;
      sum += volume->probe(i, j, k).modality, ++n;
    }
  EXPECT_GT(n, 50);
  EXPECT_EQ(static_cast<double>(there.values->n), n);
  EXPECT_NEAR(there.values->mean, sum / n, 1e-9);
  // One step of undo, the picture's turn included.
  w.key(GLFW_KEY_Z, true);
  ASSERT_TRUE(w.settle());
  EXPECT_EQ(saidOf(w, all(w)[0]), across);
  EXPECT_EQ(w.workspace().tile(1).view, "coronal");
}

}  // namespace
}  // namespace vernier::ui
