// SPDX-License-Identifier: GPL-3.0-or-later
// Hulls against their definition, in long double: a triple of points spans a face when no point lies beyond.
#include "HullSolid.h"

#include "ExactHull.h"
#include "MeshConvexity.h"
#include "RegionChecks.h"
#include "vernier/base/Random.h"
#include "vernier/lens/Shapes.h"

namespace vernier::lens {
namespace {

using namespace vernier::test;

std::vector<MeshPoint> randomPoints(std::uint64_t seed, int count, const glm::dvec3& size) {
  std::vector<MeshPoint> out;
  for (int n = 0; n < count; ++n) {
    const auto u = [&](int k) { return 2 * randomUnit(seed, 3ull * n + k) - 1; };
    out.emplace_back(size.x * u(0), size.y * u(1), size.z * u(2));
  }
  return out;
}

ConvexRegion regionOf(const std::vector<MeshPoint>& points) {
  const Result<Solid> s = hullSolid(points);
  EXPECT_TRUE(s.ok()) << (s.ok() ? "" : s.error().text());
  if (!s) return {};
  Result<ConvexRegion> r = placed(*s, {});
  EXPECT_TRUE(r.ok());
  return r.ok() ? *r : ConvexRegion{};
}

// All planes through three of the points that have all points on one side: normal (unit) and offset.
std::vector<std::array<double, 4>> bruteFaces(const std::vector<MeshPoint>& p) {
  std::vector<std::array<double, 4>> out;
  for (std::size_t a = 0; a < p.size(); ++a)
    for (std::size_t b = a + 1; b < p.size(); ++b)
      for (std::size_t c = b + 1; c < p.size(); ++c) {
        Long3 n = vernier::test::cross(minus(toLong(p[b].p), toLong(p[a].p)),
                                       minus(toLong(p[c].p), toLong(p[a].p)));
        const long double l = std::sqrt(vernier::test::dot(n, n));
        for (long double& k : n) k /= l;
        bool above = false, below = false;
        for (std::size_t k = 0; k < p.size(); ++k) {
          if (k == a || k == b || k == c) continue;
          const long double d = vernier::test::dot(n, minus(toLong(p[k].p), toLong(p[a].p)));
          above = above || d > 0, below = below || d < 0;
        }
        if (above && below) continue;
        if (above)
          for (long double& k : n) k = -k;
        out.push_back({static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2]),
                       static_cast<double>(vernier::test::dot(n, toLong(p[a].p)))});
      }
  return out;
}

TEST(LensHull, EqualsBruteForce) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const int count = 4 + static_cast<int>(seed % 25);
    const glm::dvec3 size = seed % 3 == 0 ? glm::dvec3(100, 3, 0.5) : glm::dvec3(50);
    const std::vector<MeshPoint> points = randomPoints(seed, count, size);
    const ConvexRegion r = regionOf(points);
    expectRegion(r, 1e-9);
    const auto faces = bruteFaces(points);
    ASSERT_EQ(r.planes.size(), faces.size()) << "seed " << seed;
    for (const auto& f : faces) {
      double best = 1e300;
      for (const HalfSpace& h : r.planes)
        best = std::min(
            best, glm::distance(h.normal.v, glm::dvec3(f[0], f[1], f[2])) + std::abs(h.offset_mm - f[3]));
      EXPECT_LT(best, 1e-9) << "seed " << seed;
    }
  }
}

TEST(LensHull, HoldsAllPointsAndEachFaceIsTouched) {
  for (std::uint64_t seed = 100; seed < 130; ++seed) {
    std::vector<MeshPoint> points =
        randomPoints(seed, 1000 + 300 * static_cast<int>(seed % 10), {80, 60, 40});
    if (seed % 2)  // on an ellipsoid: all of them are corners
      for (MeshPoint& p : points) p = MeshPoint(glm::normalize(p.p) * glm::dvec3(80, 60, 40));
    const ConvexRegion r = regionOf(points);
    expectRegion(r, 1e-9);
    if (seed % 2) {
      EXPECT_EQ(r.corners.size(), points.size());
    }
    std::size_t outside = 0, untouched = 0;
    for (const HalfSpace& h : r.planes) {
      int touching = 0;
      for (const MeshPoint& p : points) {
        const double d = h.distance_mm(PatientPoint(p.p));
        outside += d > 1e-9, touching += d > -1e-9;
      }
      untouched += touching < 3;
    }
    EXPECT_EQ(outside, 0u);
    EXPECT_EQ(untouched, 0u);
  }
}

TEST(LensHull, OrderAndRepetitionDoNotMatter) {
  std::vector<MeshPoint> points = randomPoints(7, 500, glm::dvec3(20));
  const ConvexRegion first = regionOf(points);
  std::reverse(points.begin(), points.end());
  points.insert(points.end(), points.begin(), points.begin() + 250);
  const ConvexRegion second = regionOf(points);
  EXPECT_EQ(first.planes.size(), second.planes.size());
  EXPECT_NEAR(volumeOf(first), volumeOf(second), 1e-9);
}

// Normals of triangles as thin as doubles can make them. The corners lie in the plane z = x / 2 + y / 4
// exactly (x and y are multiples of 2^-38), and their products fit no double.
TEST(LensHull, NormalsOfThinTrianglesAreRight) {
  const glm::dvec3 truth = glm::normalize(glm::dvec3(-2, -1, 4));
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto inPlane = [](double x, double y) { return glm::dvec3(x, y, x / 2 + y / 4); };
    const auto draw = [&](std::uint64_t n) {
      return std::floor(64 * randomUnit(seed, n) * 0x1p38) * 0x1p-38;
    };
    const glm::dvec3 a = inPlane(draw(0), draw(1)), b = inPlane(draw(2), draw(3));
    const double x = std::floor((a.x + b.x) / 2 * 0x1p38) * 0x1p-38,
                 y = std::floor((a.y + b.y) / 2 * 0x1p38) * 0x1p-38;
    const glm::dvec3 c = inPlane(x, y + 0x1p-28);  // beside the middle
    const double sign = vernier::test::cross(toLong(b - a), toLong(c - a))[2] > 0 ? 1 : -1;
    EXPECT_LT(glm::distance(exactNormal(a, b, c), sign * truth), 1e-14);
    EXPECT_LT(glm::distance(exactNormal(b, c, a), sign * truth), 1e-14);
    EXPECT_LT(glm::distance(exactNormal(a, c, b), -sign * truth), 1e-14);
  }
  const glm::dvec3 a(1, 2, 3), b(5, 7, 11);
  EXPECT_EQ(exactNormal(a, b, 0.5 * (a + b)), glm::dvec3(0));
  EXPECT_EQ(exactNormal(a, a, b), glm::dvec3(0));
}

TEST(LensHull, ThinTrianglesGoWithTheirCorner) {
  // A cube, and a point just outside a face and beside the middle of its edge: a triangle that float32 would
  // turn over.
  std::vector<MeshPoint> points;
  for (int n = 0; n < 8; ++n) points.emplace_back(n & 1 ? 10 : 0, n & 2 ? 10 : 0, n & 4 ? 10 : 0);
  points.emplace_back(5, 1e-7, -1e-7);
  const ConvexRegion r = regionOf(points);
  expectRegion(r, 1e-12);
  EXPECT_EQ(r.planes.size(), 6u);
  points.back() = MeshPoint(5, 1e-3, -1e-3);  // this one float32 can tell
  const ConvexRegion kept = regionOf(points);
  expectRegion(kept, 1e-12);
  EXPECT_EQ(kept.corners.size(), 9u);
}

TEST(LensHull, ThinnedHullsSayHowMuchSmallerTheyAre) {
  std::vector<MeshPoint> points = randomPoints(3, 60000, glm::dvec3(1));
  for (MeshPoint& p : points) p = MeshPoint(glm::normalize(p.p) * 100.0);
  const Result<Solid> s = hullSolid(points);
  ASSERT_TRUE(s.ok()) << s.error().text();
  EXPECT_LE(s->corners.size(), kMostHullPoints);
  EXPECT_GT(s->corners.size(), kMostHullPoints / 3);
  ASSERT_NE(s->notice.find("mm smaller"), std::string::npos);
  const double said = std::stod(s->notice.substr(s->notice.find("up to ") + 6));
  EXPECT_LT(said, 0.2);
  // Each point moved inwards by what was said is inside; without that some are not.
  double most = -1;
  for (std::size_t n = 0; n < points.size(); n += 37) {
    const glm::dvec3 p = points[n].p * (1 - said / 100);
    for (std::size_t t = 0; t < s->triangles.size(); ++t)
      most = std::max(most, glm::dot(s->normals[s->planeOf[t]], p - s->corners[s->triangles[t][0]]));
  }
  EXPECT_LE(most, 1e-6);
  EXPECT_GT(most, -0.5 * said);
}

}  // namespace
}  // namespace vernier::lens
