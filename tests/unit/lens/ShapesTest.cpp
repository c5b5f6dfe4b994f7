// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes in closed form, poses, the cache; against volumes and distances of school geometry.
#include "vernier/lens/Shapes.h"

#include <numbers>

#include "RegionChecks.h"

namespace vernier::lens {
namespace {

using namespace vernier::test;
constexpr double kPi = std::numbers::pi, kInf = std::numeric_limits<double>::infinity();
const double kNan = std::numeric_limits<double>::quiet_NaN();

Result<std::shared_ptr<const ConvexRegion>> make(const LensShape& shape, const PatientFromMesh& pose = {}) {
  DerivedCache cache(64 << 20);
  return convexRegion({shape, pose, CutOut{}}, {}, cache);
}

// The region, or an empty one and a failure.
ConvexRegion region(const LensShape& shape, const PatientFromMesh& pose = {}) {
  const auto r = make(shape, pose);
  EXPECT_TRUE(r.ok()) << (r.ok() ? "" : r.error().text());
  return r.ok() ? **r : ConvexRegion{};
}

void expectRefused(const LensShape& shape, const std::string& why, const PatientFromMesh& pose = {}) {
  const auto r = make(shape, pose);
  ASSERT_FALSE(r.ok()) << "expected: " << why;
  EXPECT_EQ(r.error().code, ErrorCode::SceneInvalid);
  EXPECT_NE(r.error().sentence.find(why), std::string::npos) << r.error().sentence;
}

PatientFromMesh turned(double degrees, const glm::dvec3& axis, const glm::dvec3& scale = glm::dvec3(1),
                       const glm::dvec3& to = glm::dvec3(0)) {
  const double a = degrees * kPi / 180, c = std::cos(a), s = std::sin(a);
  const glm::dvec3 u = glm::normalize(axis);
  glm::dmat3 m(0);
  for (int k = 0; k < 3; ++k) {
    glm::dvec3 e(0);
    e[k] = 1;
    m[k] = (e * c + glm::cross(u, e) * s + u * glm::dot(u, e) * (1 - c)) * scale[k];
  }
  return {m, to};
}

TEST(LensShapes, BoxHasItsFacesAndVolume) {
  const ConvexRegion r = region(BoxShape{MeshPoint(1, 2, 3), {10, 20, 30}});
  expectRegion(r, 0);
  EXPECT_EQ(r.planes.size(), 6u);
  EXPECT_EQ(r.corners.size(), 8u);
  EXPECT_DOUBLE_EQ(volumeOf(r), 6000);
  for (const HalfSpace& h : r.planes) {
    const bool high = h.normal.v.x + h.normal.v.y + h.normal.v.z > 0;
    const double centre =
        std::abs(h.normal.v.x) * 1 + std::abs(h.normal.v.y) * 2 + std::abs(h.normal.v.z) * 3;
    const double half =
        std::abs(h.normal.v.x) * 5 + std::abs(h.normal.v.y) * 10 + std::abs(h.normal.v.z) * 15;
    EXPECT_EQ(h.offset_mm, high ? centre + half : half - centre);
  }
}

TEST(LensShapes, SpheresHaveTheirCornersOnTheSphere) {
  for (int divisions = 0; divisions <= 5; ++divisions) {
    const ConvexRegion r = region(SphereShape{MeshPoint(-40, 5, 300), 70, divisions});
    expectRegion(r, 1e-12 * 300);
    const std::size_t faces = 20u << 2 * divisions;
    EXPECT_EQ(r.planes.size(), faces);
    EXPECT_EQ(r.corners.size(), faces / 2 + 2);
    for (const PatientPoint& p : r.corners)
      EXPECT_NEAR(glm::distance(p.p, glm::dvec3(-40, 5, 300)), 70, 1e-12 * 300);
    if (divisions == 0) {  // a regular icosahedron
      const double edge = 70 / std::sin(2 * kPi / 5);
      EXPECT_NEAR(volumeOf(r) / (5.0 / 12 * (3 + std::sqrt(5.0)) * edge * edge * edge), 1, 1e-12);
    }
    if (divisions == 5) {
      EXPECT_NEAR(volumeOf(r) / (4.0 / 3 * kPi * 70 * 70 * 70), 1, 1e-3);
    }
  }
}

TEST(LensShapes, ConesAndCylindersArePrisms) {
  const double rows[][3] = {{5, 5, 48}, {0, 7, 48}, {7, 0, 12}, {3, 8, 3}, {8, 3, 1000}, {30, 2, 7}};
  for (const auto& [from, to, sides] : rows) {
    const MeshPoint a(10, -3, 4), b(-20, 40, 60);
    const int n = static_cast<int>(sides);
    const ConvexRegion r = region(ConeShape{a, b, from, to, n});
    expectRegion(r, 1e-12);
    EXPECT_EQ(r.planes.size(), static_cast<std::size_t>(n + (from > 0) + (to > 0)));
    const double polygon = 0.5 * n * std::sin(2 * kPi / n);  // area of the ring of radius 1
    const double length = glm::distance(a.p, b.p);
    EXPECT_NEAR(volumeOf(r) / (polygon * length / 3 * (from * from + from * to + to * to)), 1, 1e-9);
    EXPECT_EQ(r.notice, "");
  }
}

TEST(LensShapes, ThinEndsOfConesBecomePointsAndSaySo) {
  const ConvexRegion tip = region(ConeShape{MeshPoint(0, 0, 0), MeshPoint(0, 0, 100), 1e-5, 20, 48});
  EXPECT_EQ(tip.planes.size(), 49u);
  EXPECT_NE(tip.notice.find("point"), std::string::npos);
  expectRegion(tip, 1e-12);
  const ConvexRegion wire = region(ConeShape{MeshPoint(0, 0, 0), MeshPoint(0, 0, 200), 1, 1, 1000});
  EXPECT_LT(wire.planes.size(), 500u);
  EXPECT_GT(wire.planes.size(), 100u);
  EXPECT_NE(wire.notice.find("sides"), std::string::npos);
  expectRegion(wire, 1e-12);
}

TEST(LensShapes, PosesMoveFacesAsTheyMovePoints) {
  const LensShape shapes[] = {BoxShape{MeshPoint(1, 2, 3), {10, 20, 30}},
                              SphereShape{MeshPoint(3, 0, 0), 12, 2},
                              ConeShape{MeshPoint(0, 0, 0), MeshPoint(9, 9, 30), 2, 8, 24}};
  const PatientFromMesh poses[] = {turned(33, {1, 2, 3}, {1, 1, 1}, {-100, 250, 1000}),
                                   turned(200, {0, 1, 0}, {-1, 1, 1}, {5, 5, 5}),  // a mirror
                                   turned(71, {1, -1, 0}, {0.2, 3, -7}, {0, 0, -400}),
                                   {glm::dmat3(1, 0, 0, 0.8, 1, 0, -0.3, 0.4, 1.5), {1, 2, 3}}};  // a shear
  for (const LensShape& shape : shapes) {
    const ConvexRegion still = region(shape);
    for (const PatientFromMesh& pose : poses) {
      const ConvexRegion moved = region(shape, pose);
      expectRegion(moved, 1e-11);
      EXPECT_NEAR(volumeOf(moved) / (volumeOf(still) * std::abs(glm::determinant(pose.linear))), 1, 1e-9);
      // A point belongs to the moved region when it belonged to the still one.
      std::uint64_t draw = 0;
      for (int n = 0; n < 2000; ++n) {
        glm::dvec3 p;
        for (int k = 0; k < 3; ++k)
          p[k] = 80 * static_cast<double>((draw++ * 2654435761u) % 1000003) / 1000003 - 40;
        const PatientPoint q(pose.linear * p + pose.translation);
        EXPECT_EQ(still.contains(PatientPoint(p)), moved.contains(q));
      }
    }
  }
}

// A region is closed: what lies on a face, an edge or a corner belongs to it.
TEST(LensShapes, G7FacesEdgesAndCornersBelong) {
  const ConvexRegion r = region(BoxShape{MeshPoint(0, 0, 0), {2, 4, 8}});
  EXPECT_TRUE(r.contains(PatientPoint(1, 0, 0)));
  EXPECT_TRUE(r.contains(PatientPoint(1, 2, 0)));
  EXPECT_TRUE(r.contains(PatientPoint(1, 2, 4)));
  const double above = std::nextafter(1.0, 2.0);
  EXPECT_FALSE(r.contains(PatientPoint(above, 0, 0)));
  EXPECT_FALSE(r.contains(PatientPoint(above, 2, 0)));
  EXPECT_FALSE(r.contains(PatientPoint(above, 2, 4)));
}

TEST(LensShapes, SizesThatAreNoneAreRefused) {
  for (const double bad : {0.0, -1.0, kNan, kInf, 1e-9, 1e300}) {
    expectRefused(BoxShape{MeshPoint(), {10, bad, 10}}, "size of the box");
    expectRefused(SphereShape{MeshPoint(), bad, 2}, "radius");
    if (bad != 0) expectRefused(ConeShape{MeshPoint(), MeshPoint(0, 0, 9), bad, 3, 24}, "radius");
  }
  for (const double bad : {kNan, kInf, -kInf, 1e8}) {
    expectRefused(BoxShape{MeshPoint(0, bad, 0), {1, 1, 1}}, "centre");
    expectRefused(SphereShape{MeshPoint(bad, 0, 0), 1, 2}, "centre");
    expectRefused(ConeShape{MeshPoint(bad, 0, 0), MeshPoint(), 1, 1, 9}, "beginning");
    expectRefused(ConeShape{MeshPoint(), MeshPoint(bad, 0, 0), 1, 1, 9}, "end");
  }
  expectRefused(BoxShape{MeshPoint(), {100, 100, 1e-5}}, "flat");
  expectRefused(SphereShape{MeshPoint(), 1, 6}, "0 to 5");
  expectRefused(SphereShape{MeshPoint(), 1, -1}, "0 to 5");
  expectRefused(ConeShape{MeshPoint(), MeshPoint(0, 0, 5), 0, 0, 24}, "Both radii");
  expectRefused(ConeShape{MeshPoint(1, 2, 3), MeshPoint(1, 2, 3), 1, 2, 24}, "begins where it ends");
  expectRefused(ConeShape{MeshPoint(), MeshPoint(0, 0, 5), 1, 1, 2}, "3 to 1000");
  expectRefused(ConeShape{MeshPoint(), MeshPoint(0, 0, 5), 1, 1, 1001}, "3 to 1000");
  expectRefused(ConeShape{MeshPoint(), MeshPoint(0, 0, 1000), 1e-5, 1e-5, 24}, "a line");
  expectRefused(ConeShape{MeshPoint(), MeshPoint(0, 0, 1e-5), 100, 100, 24}, "flat");
}

TEST(LensShapes, PosesThatFlattenOrLoseTheLensAreRefused) {
  const BoxShape box{MeshPoint(), {10, 10, 10}};
  expectRefused(box, "pose", {glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, 0), {}});
  expectRefused(box, "pose", {glm::dmat3(kNan), {}});
  expectRefused(box, "squeezes", {glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, 1e-7), {}});
  expectRefused(box, "away", {glm::dmat3(1), {0, 0, 1e8}});
  expectRefused(box, "too small", {glm::dmat3(1e-8), {}});
  expectRefused(box, "too small", {glm::dmat3(1e-3), {9e6, 0, 0}});
}

TEST(LensShapes, MovedHullsAreNotMadeAgain) {
  DerivedCache cache(64 << 20);
  HullShape hull;
  for (int n = 0; n < 8; ++n) hull.points.emplace_back(n & 1, n & 2, n & 4);
  LensLayer lens{hull, {}, CutOut{}};
  ASSERT_TRUE(convexRegion(lens, {}, cache).ok());
  const std::uint64_t once = cache.bytes();
  EXPECT_GT(once, 0u);
  lens.pose = turned(30, {1, 1, 0}, {1, 1, 1}, {10, 20, 30});
  const auto moved = convexRegion(lens, {}, cache);
  ASSERT_TRUE(moved.ok());
  EXPECT_NEAR(volumeOf(**moved), 8, 1e-9);
  EXPECT_EQ(cache.bytes(), once);
  std::get<HullShape>(lens.shape).points.own().back() = MeshPoint(2, 3, 5);
  const auto other = convexRegion(lens, {}, cache);
  ASSERT_TRUE(other.ok());
  EXPECT_GT(volumeOf(**other), 8.1);
  EXPECT_GT(cache.bytes(), once);
}

std::shared_ptr<const Mesh> meshOf(const std::vector<glm::dvec3>& p, const std::vector<Triangle>& t) {
  MeshBuilder b;
  std::vector<std::uint32_t> n;
  for (const glm::dvec3& v : p) n.push_back(b.vertex(v));
  for (const Triangle& f : t) b.triangle(n[f[0]], n[f[1]], n[f[2]]);
  return *b.finish();
}

TEST(LensShapes, MeshesAreConvexOrTheirHullIsAskedFor) {
  std::vector<glm::dvec3> cube;
  for (int n = 0; n < 8; ++n) cube.emplace_back(n & 1 ? 3 : 0, n & 2 ? 3 : 0, n & 4 ? 3 : 0);
  const std::vector<Triangle> faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  auto insideOut = faces, open = faces;
  for (Triangle& t : insideOut) std::swap(t[0], t[1]);
  open.pop_back();
  auto dented = cube;
  dented[7] = {1.2, 1.2, 1.2};
  Sources sources;
  sources.meshes = {{"cube", meshOf(cube, faces)},
                    {"inside out", meshOf(cube, insideOut)},
                    {"open", meshOf(cube, open)},
                    {"dented", meshOf(dented, faces)}};
  DerivedCache cache(64 << 20);
  const auto of = [&](const char* name, bool hull) {
    return convexRegion({MeshShape{name, hull}, {}, CutOut{}}, sources, cache);
  };
  for (const char* name : {"cube", "inside out"}) {
    const auto r = of(name, false);
    ASSERT_TRUE(r.ok()) << r.error().text();
    expectRegion(**r, 1e-15);
    EXPECT_EQ((*r)->planes.size(), 6u);
    EXPECT_NEAR(volumeOf(**r), 27, 1e-12);
  }
  const auto openAs = of("open", false), dentedAs = of("dented", false), none = of("elsewhere", true);
  ASSERT_FALSE(openAs.ok());
  EXPECT_NE(openAs.error().sentence.find("not closed: 3 of its edges"), std::string::npos);
  ASSERT_FALSE(dentedAs.ok());
  EXPECT_NE(dentedAs.error().sentence.find("not convex"), std::string::npos);
  ASSERT_FALSE(none.ok());
  EXPECT_NE(none.error().sentence.find("not loaded"), std::string::npos);
  const auto openHull = of("open", true), dentedHull = of("dented", true);
  ASSERT_TRUE(openHull.ok() && dentedHull.ok());
  EXPECT_NEAR(volumeOf(**openHull), 27, 1e-12);
  EXPECT_NEAR(volumeOf(**dentedHull), 27 * 5.0 / 6, 1e-9);  // a corner, a sixth, is cut off
  expectRegion(**dentedHull, 1e-12);
}

}  // namespace
}  // namespace vernier::lens
