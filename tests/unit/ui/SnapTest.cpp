// SPDX-License-Identifier: GPL-3.0-or-later
// A region on a reformat goes to the nearest acquired slice: the same outline on stored pixels.
#include "Snap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "Facts.h"
#include "vernier/plan/Presets.h"

namespace vernier::ui {
namespace {

using measure::Space;
using measure::Spot;

constexpr double kFirst_mm = 10, kStep_mm = 2;  // of axialGrid

measure::Measurement on(const Plane& plane, measure::Shape shape) {
  measure::Measurement m;
  m.id = "m1";
  m.on.source = "a";
  m.on.axes = measure::Placement::Axes{plane.normal, plane.up};
  m.on.screenPixel = 0.3;
  m.shape = std::move(shape);
  return m;
}
double toSlice(double z) { return std::abs(std::remainder(z - kFirst_mm, kStep_mm)); }

Plane axialAt(double z) { return {PatientPoint(0, 0, z), PatientVec(0, 0, -1), PatientVec(0, -1, 0)}; }

TEST(Snap, AlongTheSlicesItMovesAlongTheNormalAlone) {
  const GridGeometry g = test::axialGrid();
  const Plane between = axialAt(24.7);
  const auto s =
      snapToAcquired(on(between, measure::EllipseRegion{{Spot(-4, -3, 24.7), Spot(5, 6, 24.7)}}), between, g);
  ASSERT_TRUE(s);
  EXPECT_EQ(s->view, "");
  const auto corners = std::get<measure::EllipseRegion>(s->moved.shape).corners;
  EXPECT_LT(glm::length(corners[0] - Spot(-4, -3, 24)), 1e-9);
  EXPECT_LT(glm::length(corners[1] - Spot(5, 6, 24)), 1e-9);
  EXPECT_NEAR(s->plane.point.p.z, 24, 1e-9);
  EXPECT_EQ(s->moved.on, on(between, measure::Probe{}).on);
  EXPECT_FALSE(snapToAcquired(s->moved, s->plane, g)) << "it is there";
}

TEST(Snap, OnAnAcquiredSliceThereIsNothingToOffer) {
  const GridGeometry g = test::axialGrid();
  const measure::RectangleRegion box{{Spot(-4, -3, 24), Spot(5, 6, 24)}};
  EXPECT_FALSE(snapToAcquired(on(axialAt(24), box), axialAt(24), g));
  // Lengths have no statistics, slabs no values, stored frames are stored.
  EXPECT_FALSE(snapToAcquired(on(axialAt(24.7), measure::Length{{Spot(0, 0, 24.7), Spot(5, 0, 24.7)}}),
                              axialAt(24.7), g));
  measure::Measurement thick =
      on(axialAt(24.7), measure::RectangleRegion{{Spot(0, 0, 24.7), Spot(5, 6, 24.7)}});
  EXPECT_TRUE(snapToAcquired(thick, axialAt(24.7), g));
  thick.on.shown = measure::Shown::Slab;
  EXPECT_FALSE(snapToAcquired(thick, axialAt(24.7), g));
  thick.on.shown = measure::Shown::Slice, thick.on.space = Space::Image;
  EXPECT_FALSE(snapToAcquired(thick, axialAt(24.7), g));
}

// A triangle on a coronal plane becomes the same triangle on the axial slice nearest to its middle.
TEST(Snap, AcrossTheSlicesItIsTurnedAboutItsMiddle) {
  const GridGeometry g = test::axialGrid();
  const Plane coronal{PatientPoint(0, 2, 0), PatientVec(0, -1, 0), PatientVec(0, 0, 1)};
  const std::vector<Spot> corners{Spot(-3, 2, 20), Spot(6, 2, 21), Spot(3, 2, 30.5)};
  const auto s = snapToAcquired(on(coronal, measure::PolygonRegion{corners}), coronal, g);
  ASSERT_TRUE(s);
  EXPECT_EQ(s->view, "axial");
  EXPECT_LT(length(s->plane.normal - PatientVec(0, 0, -1)), 1e-12) << "seen from the feet";
  const auto& now = std::get<measure::PolygonRegion>(s->moved.shape).corners;
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT(toSlice(now[static_cast<std::size_t>(k)].z), 1e-9);
    const std::size_t a = static_cast<std::size_t>(k), b = (a + 1) % 3;
    EXPECT_NEAR(glm::length(now[a] - now[b]), glm::length(corners[a] - corners[b]), 1e-9);
  }
  const glm::dvec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0,
                   after = (now[0] + now[1] + now[2]) / 3.0;
  EXPECT_LT(glm::length(glm::dvec2(middle) - glm::dvec2(after)), 1e-9);
  EXPECT_LE(std::abs(middle.z - after.z), kStep_mm / 2);
  // What was to the patient's left is there still; what was up towards the head is up in the picture.
  EXPECT_NEAR(now[1].x - now[0].x, 9, 1e-9);
  EXPECT_NEAR(now[0].y - now[2].y, 10.5, 1e-9);
  EXPECT_FALSE(snapToAcquired(s->moved, s->plane, g));
}

// Slices 20 degrees from the patient's axes, sheared as by a gantry: the plane is theirs.
TEST(Snap, OfTiltedAndShearedSlices) {
  GridGeometry g = test::axialGrid();
  const double a = 20 * 3.14159265358979 / 180;
  g.patientFromVoxel.linear[1] = 0.5 * glm::dvec3(0, std::cos(a), std::sin(a));
  const Plane axial = axialAt(33.3);
  const auto s =
      snapToAcquired(on(axial, measure::RectangleRegion{{Spot(-4, -6, 33.3), Spot(5, 3, 33.3)}}), axial, g);
  ASSERT_TRUE(s);
  EXPECT_EQ(s->view, "oblique");
  const glm::dvec3 n = glm::normalize(s->plane.normal.v);
  EXPECT_NEAR(std::abs(glm::dot(n, glm::dvec3(0, -std::sin(a), std::cos(a)))), 1, 1e-12);
  EXPECT_LT(n.z, 0) << "as the axial plane is seen";
  measure::Measurement box = s->moved;
  const auto outline = linesOf(box).at(0);
  const glm::dmat3 inverse = glm::inverse(g.patientFromVoxel.linear);
  for (const Spot& p : outline)
    EXPECT_NEAR(std::remainder((inverse * (p - g.patientFromVoxel.translation)).z, 1), 0, 1e-9);
  EXPECT_NEAR(glm::length(outline[1] - outline[0]), 9, 1e-9);
  EXPECT_NEAR(glm::length(outline[2] - outline[1]), 9, 1e-9);
}

// Slices that lie unevenly: the nearest one by place, not by number.
TEST(Snap, OfUnevenSlices) {
  GridGeometry g = test::axialGrid(4);
  for (const double z : {0.0, 1.0, 4.5, 5.0}) g.sliceOrigin_vox.emplace_back(0, 0, z);
  const Plane at = axialAt(10 + 2 * 3.9);
  const auto s = snapToAcquired(
      on(at, measure::RectangleRegion{{Spot(0, 0, at.point.p.z), Spot(3, 3, at.point.p.z)}}), at, g);
  ASSERT_TRUE(s);
  EXPECT_NEAR(s->plane.point.p.z, 10 + 2 * 4.5, 1e-9);
}

TEST(Snap, TheDeskMovesRegionAndPictureInOneStep) {
  Workspace w;
  w.know(test::axialFacts(1, "a"));
  w.open({1, "a"}, 0);
  ASSERT_TRUE(w.openMpr());
  const Plane coronal = sliceOf(w.tile(1).scene)->plane;
  measure::Measurement m = on(coronal, measure::EllipseRegion{{coronal.point.p + glm::dvec3(-3, 0, -4),
                                                               coronal.point.p + glm::dvec3(4, 0, 3)}});
  m.id.clear();
  const std::string id = w.addMeasurement(1, m);
  EXPECT_TRUE(w.canSnap(id));
  const Arrangement before = w.now();
  w.snap(id);  // the list's: it finds the picture
  EXPECT_FALSE(w.canSnap(id));
  EXPECT_EQ(w.tile(1).view, "axial");
  const Plane& now = sliceOf(w.tile(1).scene)->plane;
  for (const Spot& p : measure::handlesOf(w.measurement(id)->what.shape))
    EXPECT_NEAR(dot(PatientPoint(p) - now.point, now.normal), 0, 1e-9);
  // All linked planes go through the crosshair, which went with the region.
  for (int t = 0; t < 4; ++t) {
    const Plane& plane = sliceOf(w.tile(t).scene)->plane;
    EXPECT_NEAR(dot(*w.crosshair(t) - plane.point, normalize(plane.normal)), 0, 1e-9) << t;
  }
  w.undo();
  EXPECT_EQ(w.now(), before);
}

}  // namespace
}  // namespace vernier::ui
