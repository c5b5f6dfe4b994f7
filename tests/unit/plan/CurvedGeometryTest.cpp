// SPDX-License-Identifier: GPL-3.0-or-later
// Paths with closed forms: lines, circles, helices.
#include "vernier/plan/CurvedGeometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace vernier {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

CurvedLayer layerThrough(std::vector<PatientPoint> path) {
  CurvedLayer layer;
  layer.path = std::move(path);
  layer.width_mm = 20;
  return layer;
}

// Radius R, rise c per radian, through `n` points over `turns`.
std::vector<PatientPoint> helix(double radius_mm, double rise_mm, double turns, int n) {
  std::vector<PatientPoint> path;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * kPi * turns * i / (n - 1);
    path.emplace_back(radius_mm * std::cos(a), radius_mm * std::sin(a), rise_mm * a);
  }
  return path;
}

Result<CurvedPicture> pictureOf(const CurvedLayer& layer, View view = {400, 200}, Camera camera = {}) {
  return curvedPicture(layer, camera, view);
}

glm::dvec3 upOf(const CurvedColumn& c) { return -glm::normalize(c.down.v); }
glm::dvec3 rightOf(const CurvedColumn& c) { return glm::cross(upOf(c), c.normal.v); }
bool says(const CurvedPicture& p, const char* text) {
  for (const std::string& note : p.notes)
    if (note.find(text) != std::string::npos) return true;
  return false;
}

TEST(CurvedPath, AStraightLineIsAPlane) {
  for (const CurvedForm form : {CurvedForm::Straightened, CurvedForm::Stretched}) {
    CurvedLayer layer = layerThrough({{0, 0, 0}, {30, 0, 40}, {33, 0, 44}, {60, 0, 80}});
    layer.form = form;
    layer.up = PatientVec(0, -2, 0);
    const auto p = pictureOf(layer);
    ASSERT_TRUE(p.ok());
    EXPECT_NEAR(p->length_mm, 100, 1e-9);
    EXPECT_NEAR(p->mmPerPixel, 0.25, 1e-12);  // 100 mm in 400 pixels
    EXPECT_NEAR(p->startColumn_px, 0, 1e-9);
    EXPECT_TRUE(p->notes.empty());
    for (int x = 0; x < 400; ++x) {
      const CurvedColumn& c = p->columns[static_cast<std::size_t>(x)];
      ASSERT_TRUE(c.shown);
      const double s = (x + 0.5) * 0.25;
      EXPECT_LT(glm::length(c.centre.p - glm::dvec3(0.6 * s, 0, 0.8 * s)), 1e-9);
      EXPECT_LT(glm::length(upOf(c) - glm::dvec3(0, -1, 0)), 1e-12);
      EXPECT_LT(glm::length(rightOf(c) - glm::dvec3(0.6, 0, 0.8)), 1e-9);
    }
    EXPECT_EQ(p->endRow(200) - p->firstRow(200), 80);  // 20 mm of 0.25
  }
}

TEST(CurvedPath, ArcLengthOfAHelixIsTrueAndItsFrameDoesNotTurnAboutIt) {
  const double radius = 30, rise = 8, turns = 2;
  const double speed = std::hypot(radius, rise);  // per radian
  const CurvedLayer layer = [&] {
    CurvedLayer l = layerThrough(helix(radius, rise, turns, 289));  // every 2.5 degrees
    l.up = PatientVec(-1, 0, 0);                                    // the helix' normal at its beginning
    return l;
  }();
  const auto p = pictureOf(layer, {700, 60});
  ASSERT_TRUE(p.ok());
  EXPECT_NEAR(p->length_mm, 2 * kPi * turns * speed, 1e-4);
  double offCurve = 0, offLength = 0, twist = 0;
  for (std::size_t x = 0; x < 700; ++x) {
    const CurvedColumn& c = p->columns[x];
    const double s = (static_cast<double>(x) + 0.5) * p->mmPerPixel;
    // Nearest point of the helix, by its height.
    const double a = c.centre.p.z / rise;
    offCurve = std::max(offCurve, std::abs(std::hypot(c.centre.p.x, c.centre.p.y) - radius));
    offLength = std::max(offLength, std::abs(a * speed - s));
    // Against the Frenet frame a frame without twist turns by minus torsion x length, torsion = c / (R^2 +
    // c^2).
    const glm::dvec3 tangent = glm::dvec3(-radius * std::sin(a), radius * std::cos(a), rise) / speed;
    const glm::dvec3 normal(-std::cos(a), -std::sin(a), 0);
    const glm::dvec3 binormal = glm::cross(tangent, normal);
    const double turned = -rise / (speed * speed) * s;
    const glm::dvec3 want = std::cos(turned) * normal + std::sin(turned) * binormal;
    twist = std::max(twist, glm::length(upOf(c) - want));
    EXPECT_NEAR(glm::dot(upOf(c), rightOf(c)), 0, 1e-9);
  }
  RecordProperty("off_curve_mm", std::to_string(offCurve));
  std::printf("helix: off curve %.2g mm, arc length off %.2g mm, frame off %.2g rad\n", offCurve, offLength,
              twist);
  EXPECT_LT(offCurve, 2e-5);  // the curve through points 1.4 mm apart
  EXPECT_LT(offLength, 2e-3);
  EXPECT_LT(twist, 2e-3);
}

// The frame itself, apart from how well a curve through points follows a helix: in a plane it cannot turn at
// all.
TEST(CurvedPath, InAPlaneUpStaysUpToRounding) {
  std::vector<PatientPoint> path;
  for (int i = 0; i <= 20; ++i) path.emplace_back(40 * std::cos(i * 0.3), 40 * std::sin(i * 0.3), 5);
  CurvedLayer layer = layerThrough(path);
  layer.up = PatientVec(0, 0, 1);
  const auto p = pictureOf(layer);
  ASSERT_TRUE(p.ok());
  for (const CurvedColumn& c : p->columns) EXPECT_LT(glm::length(upOf(c) - glm::dvec3(0, 0, 1)), 1e-12);
}

// Stretched: the sheet is a cylinder over the path as seen along up. Every length on it is true.
TEST(CurvedPath, StretchedSheetKeepsLengths) {
  // Seen along z a circle of radius 25, while z rises and falls.
  std::vector<PatientPoint> path;
  for (int i = 0; i <= 180; ++i) {
    const double a = i * kPi / 180;
    path.emplace_back(25 * std::cos(a), 25 * std::sin(a), 6 * std::sin(3 * a));
  }
  CurvedLayer layer = layerThrough(path);
  layer.form = CurvedForm::Stretched;
  layer.up = PatientVec(0, 0, 3);
  const auto p = pictureOf(layer, {500, 400});
  ASSERT_TRUE(p.ok());
  EXPECT_NEAR(p->length_mm, 25 * kPi, 1e-4);
  EXPECT_NEAR(p->across_mm, 20 + 12, 1e-4);  // the width beyond the path on both sides
  int shown = 0;
  for (std::size_t x = 0; x < 500; ++x) {
    const CurvedColumn& c = p->columns[x];
    if (!c.shown) continue;  // the picture is wider than the sheet
    ++shown;
    const double a = (static_cast<double>(x) + 0.5 - p->startColumn_px) * p->mmPerPixel / 25;
    EXPECT_LT(glm::length(c.centre.p - glm::dvec3(25 * std::cos(a), 25 * std::sin(a), 0)), 1e-4);
    EXPECT_LT(glm::length(upOf(c) - glm::dvec3(0, 0, 1)), 1e-12);
  }
  EXPECT_NEAR(shown * p->mmPerPixel, p->length_mm, p->mmPerPixel);
  // The path lies on the sheet: its points are found at their angle and height.
  const auto at = patientAt(*p, {250.5, p->centreRow_px});
  ASSERT_TRUE(at);
  EXPECT_NEAR(glm::length(glm::dvec2(at->p)), 25, 1e-4);
  const EdgeLetters letters = edgeLetters(*p);
  EXPECT_EQ(letters.top, "H");
  EXPECT_EQ(letters.bottom, "F");
  EXPECT_EQ(letters.left, "");  // it changes along the picture
}

TEST(CurvedPath, PixelsGoBackToTheirColumns) {
  const CurvedLayer layer = layerThrough(helix(30, 8, 0.5, 40));
  const auto p = pictureOf(layer, {300, 80});
  ASSERT_TRUE(p.ok());
  for (const glm::dvec2 pixel : {glm::dvec2(0.5, 40), {12.9, 33.25}, {299.5, 44}}) {
    const CurvedColumn& c = p->columns[static_cast<std::size_t>(pixel.x)];
    const auto at = patientAt(*p, pixel);
    ASSERT_TRUE(at);
    EXPECT_LT(glm::length(at->p - (c.centre + (pixel.y - p->centreRow_px) * c.down).p), 1e-12);
    EXPECT_NEAR(length(*at - c.centre), std::abs(pixel.y - p->centreRow_px) * p->mmPerPixel, 1e-9);
  }
  EXPECT_FALSE(patientAt(*p, {-0.5, 40}));
  EXPECT_FALSE(patientAt(*p, {300.5, 40}));
  const double beyond = 0.51 * p->across_mm / p->mmPerPixel;
  EXPECT_FALSE(patientAt(*p, {150.5, p->centreRow_px + beyond}));
}

TEST(CurvedPath, ZoomAndPanMoveThePictureNotThePath) {
  const CurvedLayer layer = layerThrough({{0, 0, 0}, {100, 0, 0}});
  Camera camera;
  camera.zoom = 2;
  camera.pan_mm = {25, 3};
  const auto p = pictureOf(layer, {400, 200}, camera);
  ASSERT_TRUE(p.ok());
  EXPECT_NEAR(p->mmPerPixel, 0.125, 1e-12);
  EXPECT_NEAR(p->columns[0].centre.p.x, 50 + 0.0625, 1e-9);  // 75 mm in the middle, 50 mm wide
  EXPECT_NEAR(p->columns[399].centre.p.x, 100 - 0.0625, 1e-9);
  EXPECT_NEAR(p->centreRow_px, 100 + 3 / 0.125, 1e-9);
  camera = {};
  camera.height_mm = 100;
  const auto q = pictureOf(layer, {400, 200}, camera);
  EXPECT_NEAR(q->mmPerPixel, 0.5, 1e-12);
  EXPECT_FALSE(q->columns[99].shown);  // 200 mm of picture, 100 of path
  EXPECT_TRUE(q->columns[100].shown);
  EXPECT_TRUE(q->columns[299].shown);
  EXPECT_FALSE(q->columns[300].shown);
}

TEST(CurvedPath, OwnUpIsThePatientAxisMostAcross) {
  const auto topOf = [](std::vector<PatientPoint> path, CurvedForm form) {
    CurvedLayer layer = layerThrough(std::move(path));
    layer.form = form;
    const auto p = pictureOf(layer);
    EXPECT_TRUE(p.ok());
    return edgeLetters(*p).top;
  };
  EXPECT_EQ(topOf({{0, 0, 0}, {50, 0, 0}}, CurvedForm::Straightened), "H");
  EXPECT_EQ(topOf({{0, 0, 0}, {0, 0, 50}}, CurvedForm::Straightened), "A");
  EXPECT_EQ(topOf({{0, 0, 0}, {0, 40, 50}}, CurvedForm::Straightened), "L");
  EXPECT_EQ(topOf({{0, 0, 0}, {30, 5, 20}, {60, 0, 50}}, CurvedForm::Stretched), "A");
}

// A dental arch in the axial plane, with its letters.
TEST(CurvedPath, LettersStandOnlyWhereTheyHoldForTheWholePicture) {
  std::vector<PatientPoint> arch;
  for (int i = 0; i <= 18; ++i)
    arch.emplace_back(-40 * std::cos(i * kPi / 18), -50 * std::sin(i * kPi / 18), 0);
  CurvedLayer layer = layerThrough(arch);
  layer.up = PatientVec(0, 0, 1);
  EXPECT_EQ(edgeLetters(*pictureOf(layer)), (EdgeLetters{"", "", "H", "F"}));
  layer = layerThrough(helix(30, 8, 2, 100));
  EXPECT_EQ(edgeLetters(*pictureOf(layer)), (EdgeLetters{"", "", "", ""}));
  layer = layerThrough({{-40, 0, 0}, {40, 0, 0}});
  layer.up = PatientVec(0, 0, 1);
  EXPECT_EQ(edgeLetters(*pictureOf(layer)), (EdgeLetters{"R", "L", "H", "F"}));
}

// --- degenerate paths: refused, or flagged.

TEST(CurvedPathDegenerate, RefusedWithASentence) {
  const std::vector<PatientPoint> line{{0, 0, 0}, {50, 0, 0}};
  struct Case {
    std::vector<PatientPoint> path;
    std::optional<PatientVec> up;
    const char* says;
  };
  const std::vector<Case> cases{
      {{}, {}, "0 points"},
      {{{1, 2, 3}}, {}, "1 point;"},
      {{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, {}, "the same"},
      {{{0, 0, 0}, {kNan, 0, 0}}, {}, "Point 2"},
      {{{0, 0, std::numeric_limits<double>::infinity()}, {1, 0, 0}}, {}, "Point 1"},
      {{{0, 0, 0}, {1e6, 0, 0}}, {}, "Point 2"},
      {{{0, 0, 0}, {50, 0, 0}, {0, 0, 0}}, {}, "turns back"},
      {{{0, 0, 0}, {50, 0, 0}, {20, 0, 0}}, {}, "turns back"},
      {line, PatientVec(0, 0, 0), "no length"},
      {line, PatientVec(kNan, 0, 0), "not finite"},
      {line, PatientVec(-3, 0, 0), "along the path"},
      {std::vector<PatientPoint>(kMostPathPoints + 1, PatientPoint(0, 0, 0)), {}, "65537 points"}};
  for (const Case& c : cases) {
    CurvedLayer layer = layerThrough(c.path);
    layer.up = c.up;
    const auto p = pictureOf(layer);
    ASSERT_FALSE(p.ok()) << c.says;
    EXPECT_EQ(p.error().code, ErrorCode::PathDegenerate) << c.says;
    EXPECT_NE(p.error().sentence.find(c.says), std::string::npos) << p.error().sentence;
  }
  CurvedLayer stretched = layerThrough(line);
  stretched.form = CurvedForm::Stretched;
  stretched.up = PatientVec(1, 0, 0);  // the whole path along up: nothing to roll out
  EXPECT_EQ(pictureOf(stretched).error().code, ErrorCode::PathDegenerate);
  for (const double width : {0.0, -1.0, kNan, 1e9}) {
    CurvedLayer layer = layerThrough(line);
    layer.width_mm = width;
    EXPECT_EQ(pictureOf(layer).error().code, ErrorCode::SceneInvalid) << width;
  }
  Camera camera;
  camera.zoom = 0;
  EXPECT_EQ(pictureOf(layerThrough(line), {10, 10}, camera).error().code, ErrorCode::SceneInvalid);
  EXPECT_EQ(pictureOf(layerThrough(line), {0, 10}).error().code, ErrorCode::SceneInvalid);
}

TEST(CurvedPathDegenerate, CoincidentPointsCountOnceAndAreSaid) {
  const auto p = pictureOf(layerThrough({{0, 0, 0}, {0, 0, 0}, {30, 5, 0}, {30, 5, 1e-9}, {60, 0, 0}}));
  const auto q = pictureOf(layerThrough({{0, 0, 0}, {30, 5, 0}, {60, 0, 0}}));
  ASSERT_TRUE(p.ok() && q.ok());
  EXPECT_TRUE(says(*p, "2 coincident points left out"));
  EXPECT_TRUE(q->notes.empty());
  EXPECT_EQ(p->length_mm, q->length_mm);
  EXPECT_EQ(p->columns[77].centre, q->columns[77].centre);
}

TEST(CurvedPathDegenerate, ATighterBendThanTheSheetReachesIsSaid) {
  const auto bend = [](double radius, double width, CurvedForm form, PatientVec up) {
    CurvedLayer layer = layerThrough(helix(radius, 0, 0.5, 60));
    layer.width_mm = width;
    layer.form = form;
    layer.up = up;
    const auto p = pictureOf(layer);
    EXPECT_TRUE(p.ok());
    return says(*p, "overlaps itself");
  };
  const PatientVec inPlane(1, 0, 0), across(0, 0, 1);
  EXPECT_TRUE(bend(9.9, 20, CurvedForm::Straightened, inPlane));
  EXPECT_FALSE(bend(10.1, 20, CurvedForm::Straightened, inPlane));
  EXPECT_FALSE(bend(5, 20, CurvedForm::Straightened, across));  // the sheet stands across the bend
  EXPECT_FALSE(bend(5, 20, CurvedForm::Stretched, across));
  CurvedLayer thick = layerThrough(helix(5, 0, 0.5, 60));
  thick.up = across;
  thick.slab = {10.5, SlabMode::Mean};
  EXPECT_TRUE(says(*pictureOf(thick), "overlaps itself"));
}

TEST(CurvedPathDegenerate, CrossingItselfIsSaid) {
  // A figure of eight, through 64 points; then lifted apart.
  const auto eight = [](double lift_mm) {
    std::vector<PatientPoint> path;
    for (int i = 0; i <= 64; ++i) {
      const double a = -0.6 + (2 * kPi - 0.8) * i / 64;  // through the middle at 0 and at pi
      path.emplace_back(40 * std::sin(a), 40 * std::sin(a) * std::cos(a), lift_mm * i / 64.0);
    }
    return layerThrough(path);
  };
  EXPECT_TRUE(says(*pictureOf(eight(0)), "crosses itself"));
  EXPECT_FALSE(says(*pictureOf(eight(5)), "crosses itself"));
  // A closed ring meets itself at its ends only.
  EXPECT_FALSE(says(*pictureOf(layerThrough(helix(40, 0, 1, 73))), "crosses itself"));
}

TEST(CurvedPathDegenerate, TenThousandPointsAreAPathToo) {
  const auto p = pictureOf(layerThrough(helix(60, 3, 5, 10000)));
  ASSERT_TRUE(p.ok());
  EXPECT_NEAR(p->length_mm, 10 * kPi * std::hypot(60, 3), 1e-4);
}

}  // namespace
}  // namespace vernier
