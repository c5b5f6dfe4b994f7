// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/LinkedViews.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "vernier/base/Random.h"
#include "vernier/plan/Presets.h"

namespace vernier {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

GridGeometry grid64() {
  GridGeometry g;
  g.columns = g.rows = 64;
  g.slices = 40;
  g.patientFromVoxel.linear[2] = {0, 0, 2};
  g.patientFromVoxel.translation = {-31, -30, -38};
  return g;
}

double offPlane(const Plane& plane, glm::dvec3 p) {
  return glm::dot(p - plane.point.p, glm::normalize(plane.normal.v));
}

SlicePicture pictureOf(const Plane& plane, double height_mm, View view, glm::dvec2 pan_mm = {0, 0}) {
  SliceLayer layer;
  layer.plane = plane;
  Camera camera;
  camera.height_mm = height_mm;
  camera.pan_mm = pan_mm;
  const GridGeometry grid = grid64();
  return *slicePicture(layer, camera, view, grid);
}

TEST(PlaneThroughTwoPoints, HoldsBothAndTheUpDirection) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto unit = [&](std::uint64_t n) { return 200 * (randomUnit(seed, n) - 0.5); };
    const PatientPoint from(unit(0), unit(1), unit(2)), to(unit(3), unit(4), unit(5));
    const PatientVec up(unit(6), unit(7), unit(8));
    const Result<Plane> plane = planeThrough(from, to, up);
    ASSERT_TRUE(plane.ok());
    EXPECT_NEAR(offPlane(*plane, from.p), 0, 1e-11);
    EXPECT_NEAR(offPlane(*plane, to.p), 0, 1e-11);
    EXPECT_NEAR(offPlane(*plane, from.p + up.v), 0, 1e-11);
    // In the picture `from` lies left of the middle, `to` as far right of it, and up is up.
    const View view{400, 300};
    const SlicePicture picture = pictureOf(*plane, 300, view);
    const glm::dvec2 a = pixelAt(picture, from), b = pixelAt(picture, to);
    const glm::dvec2 c = pixelAt(picture, from + 0.1 * up);
    EXPECT_LT(a.x, 200);
    EXPECT_NEAR(a.x + b.x, 400, 1e-9);
    EXPECT_NEAR(a.y + b.y, 300, 1e-9);
    EXPECT_NEAR(c.x, a.x, 1e-9);
    EXPECT_LT(c.y, a.y);
    EXPECT_NEAR(glm::length(b - a) * picture.mmPerPixel, length(to - from), 1e-9);
  }
}

TEST(PlaneThroughTwoPoints, RefusesWhatSpansNoPlane) {
  const PatientPoint a(1, 2, 3), b(4, 6, 3);
  const PatientVec up(0, 0, 1);
  const struct {
    PatientPoint from, to;
    PatientVec up;
    const char* says;
  } cases[] = {{a, a, up, "the same"},
               {a, PatientPoint(1 + 1e-9, 2, 3), up, "the same"},
               {a, b, PatientVec(0, 0, 0), "no length"},
               {a, b, PatientVec(-3, -4, 0), "along the line"},
               {a, b, PatientVec(3, 4, 1e-7), "along the line"},
               {a, b, PatientVec(0, kNan, 1), "not finite"},
               {PatientPoint(kNan, 0, 0), b, up, "not finite"}};
  for (const auto& c : cases) {
    const Result<Plane> plane = planeThrough(c.from, c.to, c.up);
    ASSERT_FALSE(plane.ok()) << c.says;
    EXPECT_EQ(plane.error().code, ErrorCode::PlaneDegenerate);
    EXPECT_NE(plane.error().sentence.find(c.says), std::string::npos) << plane.error().sentence;
  }
}

TEST(PixelsAndPatient, AreInversesOnThePlane) {
  const View view{320, 200};
  const SlicePicture p =
      pictureOf({PatientPoint(3, -8, 12), PatientVec(1, 2, -3), PatientVec(0.2, -1, 0)}, 170, view, {4, -9});
  for (const glm::dvec2 px : {glm::dvec2(0, 0), {0.5, 0.5}, {123.25, 7.75}, {320, 200}, {-40, 900}}) {
    const PatientPoint at = patientAt(p, px);
    EXPECT_NEAR(glm::length(pixelAt(p, at) - px), 0, 1e-10);
    EXPECT_NEAR(glm::length(pixelAt(p, at + 25.0 * p.normal) - px), 0, 1e-10);  // looks along the normal
  }
}

TEST(LinkedPlanes, MeetInTheCrosshairAndKeepTheirPictures) {
  const GridGeometry grid = grid64();
  const PatientPoint crosshair(grid.centre().p + glm::dvec3(7, -11, 13));
  const LinkedPlanes planes = linkedPlanes(grid, crosshair);
  for (const Plane& plane : {planes.axial, planes.coronal, planes.sagittal})
    EXPECT_NEAR(offPlane(plane, crosshair.p), 0, 1e-12);
  // Only the coordinate along the normal is the crosshair's: the picture's centre stays.
  EXPECT_EQ(planes.axial.point, PatientPoint(grid.centre().p.x, grid.centre().p.y, crosshair.p.z));
  EXPECT_EQ(planes.coronal.point, PatientPoint(grid.centre().p.x, crosshair.p.y, grid.centre().p.z));
  EXPECT_EQ(planes.sagittal.point, PatientPoint(crosshair.p.x, grid.centre().p.y, grid.centre().p.z));
  // The same directions as the presets of these names.
  const std::pair<const char*, Plane> named[] = {
      {"axial", planes.axial}, {"coronal", planes.coronal}, {"sagittal", planes.sagittal}};
  for (const auto& [name, plane] : named) {
    const Scene scene = *presetScene(name, "", grid, {});
    const Plane& preset = std::get<SliceLayer>(scene.layers[0]).plane;
    EXPECT_EQ(plane.normal, preset.normal) << name;
    EXPECT_EQ(plane.up, preset.up) << name;
  }
  const Plane oblique = movedThrough(obliquePlane(grid), crosshair);
  EXPECT_NEAR(offPlane(oblique, crosshair.p), 0, 1e-12);
  EXPECT_NEAR(glm::length(glm::cross(oblique.point.p - grid.centre().p, oblique.normal.v)), 0, 1e-12);
  EXPECT_EQ(movedThrough({grid.centre(), PatientVec(0, 0, 0), PatientVec(0, 1, 0)}, crosshair).point,
            grid.centre());
}

// An axial picture of 100 mm height in 200 pixels, centred on (10, 20, 30): x right is patient x, down is
// patient y.
TEST(ReferenceLine, OrthogonalPlanesGiveRowsAndColumns) {
  const View view{300, 200};
  const SlicePicture axial =
      pictureOf(patientPlane(PatientPlane::Axial, PatientPoint(10, 20, 30)), 100, view);
  // Sagittal at x = 35: 25 mm right of the centre = 50 px.
  const auto s = referenceLine(axial, view, patientPlane(PatientPlane::Sagittal, PatientPoint(35, 0, 0)));
  ASSERT_TRUE(s);
  EXPECT_NEAR((*s)[0].x, 200, 1e-9);
  EXPECT_NEAR((*s)[0].y, 0, 1e-9);
  EXPECT_NEAR((*s)[1].x, 200, 1e-9);
  EXPECT_NEAR((*s)[1].y, 200, 1e-9);
  // Coronal at y = 10: 10 mm above the centre = row 80.
  const auto c = referenceLine(axial, view, patientPlane(PatientPlane::Coronal, PatientPoint(0, 10, 0)));
  ASSERT_TRUE(c);
  EXPECT_NEAR((*c)[0].x, 0, 1e-9);
  EXPECT_NEAR((*c)[0].y, 80, 1e-9);
  EXPECT_NEAR((*c)[1].x, 300, 1e-9);
  EXPECT_NEAR((*c)[1].y, 80, 1e-9);
  // Beside the picture, and parallel to it.
  EXPECT_FALSE(referenceLine(axial, view, patientPlane(PatientPlane::Sagittal, PatientPoint(85.1, 0, 0))));
  EXPECT_TRUE(referenceLine(axial, view, patientPlane(PatientPlane::Sagittal, PatientPoint(84.9, 0, 0))));
  EXPECT_FALSE(referenceLine(axial, view, patientPlane(PatientPlane::Axial, PatientPoint(10, 20, 30))));
  EXPECT_FALSE(referenceLine(axial, view, patientPlane(PatientPlane::Axial, PatientPoint(10, 20, 99))));
  EXPECT_FALSE(referenceLine(axial, view, {PatientPoint(10, 20, 30), PatientVec(0, 0, 0), {}}));
  EXPECT_FALSE(referenceLine(axial, view, {PatientPoint(kNan, 20, 30), PatientVec(1, 0, 0), {}}));
}

TEST(ReferenceLine, A45DegreePlaneIsTheDiagonal) {
  const View view{200, 200};
  const SlicePicture axial = pictureOf(patientPlane(PatientPlane::Axial, PatientPoint(0, 0, 0)), 100, view);
  const auto line = referenceLine(axial, view, {PatientPoint(0, 0, 5), PatientVec(1, -1, 0), {}});
  ASSERT_TRUE(line);
  EXPECT_NEAR(glm::length((*line)[0] - glm::dvec2(0, 0)), 0, 1e-9);
  EXPECT_NEAR(glm::length((*line)[1] - glm::dvec2(200, 200)), 0, 1e-9);
  // Through one corner only: nothing to draw.
  EXPECT_FALSE(referenceLine(axial, view, {PatientPoint(-50, 50, 0), PatientVec(1, -1, 0), {}}));
}

TEST(ReferenceLine, LiesOnBothPlanesAndOnTheBorder) {
  const View view{311, 207};
  int drawn = 0;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    const auto unit = [&](std::uint64_t n) { return 2 * randomUnit(seed, n) - 1; };
    const Plane shown{PatientPoint(30 * unit(0), 30 * unit(1), 30 * unit(2)),
                      PatientVec(unit(3), unit(4), unit(5)), PatientVec(unit(6), unit(7), unit(8))};
    const Plane other{PatientPoint(60 * unit(9), 60 * unit(10), 60 * unit(11)),
                      PatientVec(unit(12), unit(13), unit(14)), PatientVec(unit(15), unit(16), unit(17))};
    const SlicePicture picture = pictureOf(shown, 120, view);
    const auto line = referenceLine(picture, view, other);
    if (!line) {  // then the picture's corners all lie on one side
      int positive = 0;
      for (const glm::dvec2 c : {glm::dvec2(0, 0), {311, 0}, {0, 207}, {311, 207}})
        positive += offPlane(other, patientAt(picture, c).p) > 0 ? 1 : 0;
      EXPECT_TRUE(positive == 0 || positive == 4) << seed;
      continue;
    }
    ++drawn;
    for (const glm::dvec2 end : *line) {
      EXPECT_NEAR(offPlane(other, patientAt(picture, end).p), 0, 1e-9) << seed;
      const double border =
          std::min({std::abs(end.x), std::abs(end.y), std::abs(end.x - 311), std::abs(end.y - 207)});
      EXPECT_LT(border, 1e-9) << seed;
      EXPECT_TRUE(end.x > -1e-9 && end.x < 311 + 1e-9 && end.y > -1e-9 && end.y < 207 + 1e-9) << seed;
    }
    EXPECT_LE((*line)[0].x, (*line)[1].x) << seed;
  }
  EXPECT_GT(drawn, 100);
}

}  // namespace
}  // namespace vernier
