// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements on the desktop: where they stand, where they show, and undo.
#include "Measuring.h"

#include <gtest/gtest.h>

#include "Facts.h"
#include "vernier/plan/Presets.h"

namespace vernier::ui {
namespace {

using measure::Space;
using measure::Spot;

TEST(Measuring, EachRulerTakesItsPointsInOrder) {
  std::set<std::string> keys;
  for (const RulerFacts& f : rulers()) {
    EXPECT_TRUE(keys.insert(f.key).second) << f.key << " stands for two tools";
    std::vector<Spot> points;
    for (std::size_t n = 0; n < (f.points > 0 ? f.points : 7); ++n) points.emplace_back(n, 2 * n + 1, 0);
    const measure::Shape s = shapeOf(f.ruler, points);
    EXPECT_EQ(measure::handlesOf(s), points) << f.name;
  }
}

TEST(Measuring, PointsOfOneMeasurementStandOnOneFrameAndOnePlane) {
  const SourceFacts facts = test::axialFacts(1, "a");
  const View view{200, 160};
  Scene stack = stackScene("a", 7, {});
  const Place flat = *placeOf(stack, facts, &*facts.grid, view);
  const auto frame = *placementOn(stack, facts.id, flat);
  EXPECT_TRUE(standsOn(frame, Spot(3, 4, 0), stack, facts.id, flat));
  std::get<ImageLayer>(stack.layers[0]).index = 8;
  EXPECT_FALSE(standsOn(frame, Spot(3, 4, 0), stack, facts.id, flat));

  Scene axial = *presetScene("axial", "a", *facts.grid, {});
  Place place = *placeOf(axial, facts, &*facts.grid, view);
  const auto on = *placementOn(axial, facts.id, place);
  const Spot here = place.patientAt({20, 30}).p;
  EXPECT_TRUE(standsOn(on, here, axial, facts.id, place));
  EXPECT_FALSE(standsOn(frame, here, axial, facts.id, place));
  Scene magnified = axial;
  magnified.camera.zoom = 3;
  EXPECT_TRUE(standsOn(on, here, magnified, facts.id, *placeOf(magnified, facts, &*facts.grid, view)));
  Plane& p = std::get<SliceLayer>(axial.layers[0]).plane;
  p.point = p.point + 0.01 * p.normal;
  place = *placeOf(axial, facts, &*facts.grid, view);
  EXPECT_FALSE(standsOn(on, here, axial, facts.id, place)) << "scrolled away";
}

TEST(Measuring, APixelOfThePictureIsASpotAndBack) {
  const SourceFacts facts = test::axialFacts(1, "a");
  const View view{200, 160};
  // A stored frame: the picture's corner of pixel (0, 0) is 0, 0.
  Scene stack = stackScene("a", 7, {});
  const Place flat = *placeOf(stack, facts, &*facts.grid, view);
  const auto on = placementOn(stack, facts.id, flat);
  ASSERT_TRUE(on);
  EXPECT_EQ(on->space, Space::Image);
  EXPECT_EQ(on->frame, 7);
  EXPECT_NEAR(on->screenPixel * std::abs(flat.image->pxPerColumn), 1, 1e-12);
  const Spot corner = spotAt(flat, Space::Image, {flat.image->x0, flat.image->y0});
  EXPECT_NEAR(corner.x, 0, 1e-12);
  EXPECT_NEAR(corner.y, 0, 1e-12);
  const glm::dvec2 px(63.25, 41.5);
  EXPECT_LT(glm::length(pixelOf(flat, Space::Image, spotAt(flat, Space::Image, px)) - px), 1e-9);
  // A slice: the patient's mm.
  const Scene axial = *presetScene("axial", "a", *facts.grid, {});
  const Place plane = *placeOf(axial, facts, &*facts.grid, view);
  const auto there = placementOn(axial, facts.id, plane);
  ASSERT_TRUE(there && there->axes);
  EXPECT_EQ(there->shown, measure::Shown::Slice);
  EXPECT_NEAR(there->screenPixel, plane.unit_mm, 1e-12);
  EXPECT_LT(glm::length(pixelOf(plane, Space::Patient, spotAt(plane, Space::Patient, px)) - px), 1e-9);
  Scene thick = axial;
  std::get<SliceLayer>(thick.layers[0]).slab.thickness_mm = 10;
  EXPECT_EQ(placementOn(thick, facts.id, plane)->shown, measure::Shown::Slab);
}

TEST(Measuring, ItShowsOnItsOwnFrameAndPlane) {
  const SourceFacts facts = test::axialFacts(1, "a"), other = test::axialFacts(1, "b", "9.9.9");
  const View view{200, 160};
  Scene stack = stackScene("a", 7, {});
  const Place flat = *placeOf(stack, facts, &*facts.grid, view);
  Drawn d{1, {}};
  d.what.on = *placementOn(stack, facts.id, flat);
  d.what.shape = measure::Length{{Spot(1, 1, 0), Spot(5, 5, 0)}};
  EXPECT_TRUE(shownOn(d, stack, facts.id, flat, facts, &facts));
  std::get<ImageLayer>(stack.layers[0]).index = 8;
  EXPECT_FALSE(shownOn(d, stack, facts.id, flat, facts, &facts));
  std::get<ImageLayer>(stack.layers[0]).index = 7;
  EXPECT_FALSE(shownOn(d, stack, {1, "b"}, flat, facts, &facts));
  EXPECT_FALSE(shownOn(d, stack, {2, "a"}, flat, facts, &facts))
      << "another document's stack of the same name";

  Scene axial = *presetScene("axial", "a", *facts.grid, {});
  Place plane = *placeOf(axial, facts, &*facts.grid, view);
  d.what.on = *placementOn(axial, facts.id, plane);
  d.what.shape = measure::Length{{plane.patientAt({20, 20}).p, plane.patientAt({60, 30}).p}};
  EXPECT_TRUE(shownOn(d, axial, facts.id, plane, facts, &facts));
  EXPECT_FALSE(shownOn(d, axial, facts.id, plane, facts, &other)) << "another frame of reference";
  Plane& p = std::get<SliceLayer>(axial.layers[0]).plane;
  p.point = p.point + 2.0 * p.normal;
  plane = *placeOf(axial, facts, &*facts.grid, view);
  EXPECT_FALSE(shownOn(d, axial, facts.id, plane, facts, &facts)) << "the next slice";
}

TEST(Measuring, EllipsesAndBoxesAreDrawnBetweenTheirCorners) {
  measure::Measurement m;
  m.on.axes = measure::Placement::Axes{PatientVec(0.6, 0, 0.8), PatientVec(0, 2, 0)};
  const glm::dvec3 up(0, 1, 0), right = glm::cross(up, glm::dvec3(0.6, 0, 0.8));
  const Spot a(1, 2, 3), b = a + 6.0 * right - 4.0 * up;
  m.shape = measure::RectangleRegion{{a, b}};
  const auto box = linesOf(m).at(0);
  ASSERT_EQ(box.size(), 5u);
  EXPECT_LT(glm::length(box[1] - (a + 6.0 * right)), 1e-12);
  EXPECT_LT(glm::length(box[2] - b), 1e-12);
  m.shape = measure::EllipseRegion{{a, b}};
  const auto round = linesOf(m).at(0);
  for (const Spot& p : round) {
    const glm::dvec3 d = p - 0.5 * (a + b);
    EXPECT_NEAR(std::pow(glm::dot(d, right) / 3, 2) + std::pow(glm::dot(d, up) / 2, 2), 1, 1e-12);
  }
}

TEST(Measuring, AddingChangingAndRemovingAreStepsOfUndo) {
  Workspace w;
  w.know(test::axialFacts(1, "a"));
  w.open({1, "a"}, 0);
  measure::Measurement m;
  m.shape = measure::Length{{Spot(0, 0, 0), Spot(1, 0, 0)}};
  const std::string first = w.addMeasurement(1, m), second = w.addMeasurement(1, m);
  EXPECT_NE(first, second);
  w.scroll(0, 1);
  w.beginDrag();  // a drag of a handle is one step
  for (int n = 0; n < 9; ++n) {
    m = w.measurement(first)->what;
    measure::setHandle(m.shape, 1, Spot(2 + n, 0, 0));
    w.changeMeasurement(m);
  }
  EXPECT_TRUE(w.endDrag());
  w.removeMeasurement(second);
  EXPECT_EQ(w.now().measurements.size(), 1u);
  w.undo();
  EXPECT_EQ(w.now().measurements.size(), 2u);
  w.undo();
  EXPECT_EQ(std::get<measure::Length>(w.measurement(first)->what.shape).ends[1].x, 1);
  w.undo();  // the scroll
  w.undo();
  w.undo();
  EXPECT_TRUE(w.now().measurements.empty());
  for (int n = 0; n < 5; ++n) w.redo();
  EXPECT_EQ(w.now().measurements.size(), 1u);
  EXPECT_EQ(std::get<measure::Length>(w.measurement(first)->what.shape).ends[1].x, 10);
  w.forget(1);
  EXPECT_TRUE(w.now().measurements.empty());
}

}  // namespace
}  // namespace vernier::ui
