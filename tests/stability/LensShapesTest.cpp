// SPDX-License-Identifier: GPL-3.0-or-later
// Extreme cases G1 to G5 and G7: points that are no body, noise, float32, a million points, corners that
// belong.
#include <numbers>

#include "RegionChecks.h"
#include "vernier/base/Random.h"
#include "vernier/lens/Shapes.h"

namespace vernier::lens {
namespace {

using namespace vernier::test;

Result<std::shared_ptr<const ConvexRegion>> make(const LensShape& shape, const PatientFromMesh& pose = {}) {
  DerivedCache cache(256 << 20);
  return convexRegion({shape, pose, CutOut{}}, {}, cache);
}

std::string refusal(const std::vector<MeshPoint>& points) {
  const auto r = make(HullShape{points});
  return r.ok() ? "it was taken" : r.error().sentence;
}

ConvexRegion region(const LensShape& shape, const PatientFromMesh& pose = {}) {
  const auto r = make(shape, pose);
  EXPECT_TRUE(r.ok()) << (r.ok() ? "" : r.error().text());
  return r.ok() ? **r : ConvexRegion{};
}

PatientFromMesh turned(const glm::dvec3& to) {
  const double c = std::cos(0.7), s = std::sin(0.7), d = std::cos(0.3), t = std::sin(0.3);
  return {glm::dmat3(c, s, 0, -s, c, 0, 0, 0, 1) * glm::dmat3(1, 0, 0, 0, d, t, 0, -t, d), to};
}

// k points along each edge of a cube, on its faces only or all through it.
std::vector<MeshPoint> grid(int k, double step, bool filled) {
  std::vector<MeshPoint> out;
  const auto rim = [k](int a) { return a == 0 || a == k - 1; };
  for (int a = 0; a < k; ++a)
    for (int b = 0; b < k; ++b)
      for (int c = 0; c < k; ++c)
        if (filled || rim(a) || rim(b) || rim(c)) out.emplace_back(a * step, b * step, c * step);
  return out;
}

TEST(LensShapes, G1PointsWithoutVolumeAreRefused) {
  std::vector<MeshPoint> line;
  for (int n = 0; n <= 3; ++n) {
    EXPECT_NE(refusal(line).find("volume"), std::string::npos) << refusal(line);
    line.emplace_back(n, 2 * n, 3 * n);
  }
  for (int n = 4; n < 100; ++n) line.emplace_back(n, 2 * n, 3 * n);
  EXPECT_NE(refusal(line).find("in a line"), std::string::npos) << refusal(line);
  EXPECT_NE(refusal(std::vector<MeshPoint>(50, MeshPoint(4, 5, 6))).find("all equal"), std::string::npos);
}

TEST(LensShapes, G2CoplanarPointsAreRefused) {
  std::vector<MeshPoint> plane;
  for (int n = 0; n < 400; ++n) plane.emplace_back(n % 20, n / 20, 2 * (n % 20) - 3 * (n / 20));
  EXPECT_NE(refusal(plane).find("in a plane"), std::string::npos) << refusal(plane);
  for (MeshPoint& p : plane) p = MeshPoint((turned({}) * p).p);  // now to rounding only
  EXPECT_NE(refusal(plane).find("in a plane"), std::string::npos) << refusal(plane);
}

TEST(LensShapes, G3NoiseOf1em12MakesNoFaces) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<MeshPoint> points = grid(12, 5, false);
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (seed % 2) points[n] = MeshPoint((turned({}) * points[n]).p);
      for (int k = 0; k < 3; ++k) points[n].p[k] += 1e-12 * (2 * randomUnit(seed, 3 * n + k) - 1);
    }
    const ConvexRegion r = region(HullShape{points});
    expectRegion(r, 1e-9);
    EXPECT_EQ(r.planes.size(), 6u);
    EXPECT_NEAR(volumeOf(r) / (55.0 * 55 * 55), 1, 1e-9);
  }
}

TEST(LensShapes, G4RoundingToFloatTurnsNoFaceOver) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    std::vector<MeshPoint> points;
    for (std::uint64_t n = 0; n < 3000; ++n) {
      glm::dvec3 p;
      for (int k = 0; k < 3; ++k) p[k] = 2 * randomUnit(seed, 3 * n + k) - 1;
      // On a sphere; crowded towards a pole, so that corners come as near to each other as 1e-9 of the size.
      if (seed % 3 == 0) p = glm::normalize(p);
      if (seed % 3 == 1) p = glm::normalize(glm::dvec3(p.x * p.x * p.x, p.y * p.y * p.y, 1e-3));
      if (seed % 3 == 2) p.z = p.x * p.x + p.y * p.y;
      points.emplace_back(60.0 * p);
    }
    expectRegion(region(HullShape{points}), 1e-9);
    expectRegion(region(HullShape{points}, turned({-120, 45, 900})), 1e-9);
  }
  for (int divisions = 0; divisions <= 5; ++divisions)
    EXPECT_EQ(invertedInFloat(region(SphereShape{MeshPoint(1, 2, 3), 80, divisions}, turned({100, 0, 700}))),
              0u);
  for (const int sides : {3, 48, 1000})
    for (const double thin : {1e-6, 0.01, 1.0})
      EXPECT_EQ(invertedInFloat(region(ConeShape{MeshPoint(), MeshPoint(70, 70, 70), thin, 30, sides})), 0u);
}

TEST(LensShapes, G5AMillionGridPointsAreACube) {
  const std::vector<MeshPoint> points = grid(100, 0.5, true);
  ASSERT_EQ(points.size(), 1000000u);
  const ConvexRegion r = region(HullShape{points});
  expectRegion(r, 1e-9);
  EXPECT_EQ(r.planes.size(), 6u);
  EXPECT_EQ(r.corners.size(), 8u);
  EXPECT_NEAR(volumeOf(r) / (49.5 * 49.5 * 49.5), 1, 1e-12);
  EXPECT_EQ(r.notice, "");
}

TEST(LensShapes, G5AMillionTurnedGridPointsAreACube) {
  std::vector<MeshPoint> points = grid(100, 0.5, true);
  for (MeshPoint& p : points) p = MeshPoint((turned({}) * p).p);
  const ConvexRegion r = region(HullShape{points});
  expectRegion(r, 1e-9);
  EXPECT_EQ(r.planes.size(), 6u);
  EXPECT_NEAR(volumeOf(r) / (49.5 * 49.5 * 49.5), 1, 1e-9);
}

TEST(LensShapes, G5AMillionCornersAreThinnedWithANotice) {
  std::vector<MeshPoint> points;
  for (std::uint64_t n = 0; n < 1000000; ++n) {
    const double z = 1 - (2 * static_cast<double>(n) + 1) / 1e6, r = std::sqrt(1 - z * z);
    const double a = static_cast<double>(n) * std::numbers::pi * (3 - std::sqrt(5.0));
    points.emplace_back(90 * r * std::cos(a), 60 * r * std::sin(a), 120 * z);
  }
  const ConvexRegion r = region(HullShape{points});
  expectClosed(r);
  EXPECT_EQ(invertedInFloat(r), 0u);
  EXPECT_LE(r.corners.size(), kMostHullPoints);
  EXPECT_NE(r.notice.find("1000000 points"), std::string::npos) << r.notice;
  EXPECT_NE(r.notice.find("mm smaller"), std::string::npos) << r.notice;
  EXPECT_NEAR(volumeOf(r) / (4.0 / 3 * std::numbers::pi * 90 * 60 * 120), 1, 2e-3);
}

// From 100,000 points in a ball: exact, each point inside.
TEST(LensShapes, AHullOf100000PointsHoldsThemAll) {
  std::vector<MeshPoint> points;
  for (std::uint64_t n = 0; points.size() < 100000; ++n) {
    glm::dvec3 p;
    for (int k = 0; k < 3; ++k) p[k] = 2 * randomUnit(11, 3 * n + k) - 1;
    if (glm::length(p) < 1) points.emplace_back(70.0 * p);
  }
  const ConvexRegion r = region(HullShape{points});
  expectRegion(r, 1e-9);
  EXPECT_EQ(r.notice, "");
  double outside = 0;
  for (const HalfSpace& h : r.planes)
    for (const MeshPoint& p : points) outside = std::max(outside, h.distance_mm(PatientPoint(p.p)));
  EXPECT_LE(outside, 1e-9);
}

// Whatever the pose: corners, and what lies between corners of one face, to rounding, belong.
TEST(LensShapes, G7CornersEdgesAndFacesBelong) {
  for (const LensShape& shape :
       {LensShape(BoxShape{MeshPoint(1, 2, 3), {30, 20, 10}}), LensShape(SphereShape{MeshPoint(), 40, 2}),
        LensShape(ConeShape{MeshPoint(), MeshPoint(20, 30, 40), 3, 12, 24})}) {
    const ConvexRegion r = region(shape, turned({55, -66, 777}));
    const double rounding = 1e-12 * 800;
    glm::dvec3 middle(0);
    for (const PatientPoint& p : r.corners) middle += p.p / static_cast<double>(r.corners.size());
    for (const PatientPoint& p : r.corners)
      for (const HalfSpace& h : r.planes) EXPECT_LE(h.distance_mm(p), rounding);
    for (std::size_t n = 0; n < r.triangles.size(); ++n) {
      const auto& [a, b, c] = r.triangles[n];
      const HalfSpace& own = r.planes[r.planeOf[n]];
      for (const std::uint32_t v : {a, b, c}) EXPECT_TRUE(own.contains(r.corners[v]));
      const glm::dvec3 edge = 0.5 * (r.corners[a].p + r.corners[b].p);
      const glm::dvec3 face = (r.corners[a].p + r.corners[b].p + r.corners[c].p) / 3.0;
      for (const glm::dvec3& p : {edge, face}) {
        EXPECT_TRUE(r.contains(PatientPoint(p + 10 * rounding * glm::normalize(middle - p))));
        EXPECT_FALSE(r.contains(PatientPoint(p + own.normal.v * rounding)));
      }
    }
  }
}

}  // namespace
}  // namespace vernier::lens
