// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "vernier/volume/MeshFacts.h"
#include "vernier/volume/SurfaceFile.h"

namespace vernier::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void addQuad(MeshBuilder& b, glm::dvec3 p, glm::dvec3 q, glm::dvec3 r, glm::dvec3 s) {
  const std::uint32_t v[4] = {b.vertex(p), b.vertex(q), b.vertex(r), b.vertex(s)};
  b.triangle(v[0], v[1], v[2]);
  b.triangle(v[0], v[2], v[3]);
}

// A box of 12 triangles, facing outwards; `skip` leaves a side out, `turn` maps it.
void addBox(MeshBuilder& b, glm::dvec3 low, glm::dvec3 high, int skip = -1,
            glm::dmat3 turn = glm::dmat3(1.0)) {
  const auto at = [&](int i, int j, int k) {
    return turn * glm::dvec3(i ? high.x : low.x, j ? high.y : low.y, k ? high.z : low.z);
  };
  const auto side = [&](int n, glm::dvec3 p, glm::dvec3 q, glm::dvec3 r, glm::dvec3 s) {
    if (n != skip) addQuad(b, p, q, r, s);
  };
  side(0, at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0));
  side(1, at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
  side(2, at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
  side(3, at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0));
  side(4, at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
  side(5, at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
}

std::shared_ptr<const Mesh> finished(MeshBuilder& b) {
  Result<std::shared_ptr<const Mesh>> mesh = b.finish();
  EXPECT_TRUE(mesh.ok());
  return *mesh;
}

bool has(const std::vector<Finding>& findings, const char* code) {
  for (const Finding& f : findings)
    if (f.code == code) return true;
  return false;
}

TEST(Mesh, AClosedBoxHasItsAreaVolumeAndEdges) {
  MeshBuilder b;
  addBox(b, {-1, 2, 3}, {1, 5, 8});
  const auto mesh = finished(b);
  EXPECT_EQ(mesh->vertices().size(), 8u);
  EXPECT_EQ(mesh->triangles().size(), 12u);
  EXPECT_EQ(mesh->lowest(), MeshPoint(-1, 2, 3));
  EXPECT_EQ(mesh->highest(), MeshPoint(1, 5, 8));
  const MeshFacts f = meshFacts(*mesh);
  EXPECT_EQ(f.distinctEdges, 18u);
  EXPECT_TRUE(f.closed);
  EXPECT_NEAR(f.area_mm2, 2 * (2 * 3 + 3 * 5 + 5 * 2), 1e-12);
  EXPECT_NEAR(f.signedVolume_mm3, 30, 1e-12);
  EXPECT_TRUE(surfaceFindings(*mesh, f).empty());
}

TEST(Mesh, FarFromTheOriginTheVolumeKeepsItsDigits) {
  MeshBuilder b;
  addBox(b, {1e6, 1e6, 1e6}, {1e6 + 1, 1e6 + 1, 1e6 + 1});
  EXPECT_NEAR(meshFacts(*finished(b)).signedVolume_mm3, 1, 1e-9);
}

TEST(Mesh, TheExtentAlongThePrincipalAxisDoesNotDependOnTheRotation) {
  const double a = 0.7;
  const glm::dmat3 z({std::cos(a), std::sin(a), 0}, {-std::sin(a), std::cos(a), 0}, {0, 0, 1});
  const glm::dmat3 x({1, 0, 0}, {0, std::cos(a), std::sin(a)}, {0, -std::sin(a), std::cos(a)});
  MeshBuilder straight, turned;
  addBox(straight, {-1, -2, -20}, {1, 2, 20});
  addBox(turned, {-1, -2, -20}, {1, 2, 20}, -1, z * x);
  EXPECT_NEAR(meshFacts(*finished(turned)).extentAlongPrincipalAxis_mm,
              meshFacts(*finished(straight)).extentAlongPrincipalAxis_mm, 1e-9);
}

TEST(Mesh, OpenDuplicateInsideOutAndNonManifoldAreSaid) {
  MeshBuilder open;
  addBox(open, {0, 0, 0}, {1, 1, 1}, 1);
  const auto lid = finished(open);
  MeshFacts f = meshFacts(*lid);
  EXPECT_EQ(f.edgesUsedOnce, 4u);
  EXPECT_FALSE(f.closed);
  EXPECT_TRUE(has(surfaceFindings(*lid, f), "open-surface"));

  MeshBuilder twice;
  addBox(twice, {0, 0, 0}, {1, 1, 1});
  addQuad(twice, {0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0});
  const auto repeated = finished(twice);
  f = meshFacts(*repeated);
  EXPECT_EQ(f.duplicateTriangles, 2u);
  EXPECT_EQ(repeated->triangles().size(), 14u);
  EXPECT_TRUE(has(surfaceFindings(*repeated, f), "duplicate-triangles"));

  MeshBuilder inside;
  addBox(inside, {0, 0, 0}, {1, 1, 1}, -1, glm::dmat3({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  const auto mirrored = finished(inside);
  f = meshFacts(*mirrored);
  EXPECT_TRUE(f.closed);
  EXPECT_NEAR(f.signedVolume_mm3, -1, 1e-12);
  EXPECT_TRUE(has(surfaceFindings(*mirrored, f), "inside-out"));

  MeshBuilder touching;
  addBox(touching, {0, 0, 0}, {1, 1, 1});
  addBox(touching, {1, 1, 0}, {2, 2, 1});
  const auto pair = finished(touching);
  f = meshFacts(*pair);
  EXPECT_EQ(f.edgesUsedOverTwice, 1u);
  EXPECT_FALSE(f.closed);
  EXPECT_TRUE(has(surfaceFindings(*pair, f), "not-manifold"));
}

TEST(Mesh, AScrewOfThirtyMetresIsRemarkedOn) {
  MeshBuilder b;
  addBox(b, {0, 0, 0}, {4500, 4500, 30000});
  const auto mesh = finished(b);
  EXPECT_TRUE(has(surfaceFindings(*mesh, meshFacts(*mesh)), "size-unlikely"));
}

// NUMERICS E6.
TEST(Mesh, E6_ZeroAreaDuplicateVertexAndNaNAreDroppedAndCounted) {
  MeshBuilder b;
  addBox(b, {0, 0, 0}, {1, 1, 1});
  const std::uint32_t p = b.vertex({0, 0, 0}), q = b.vertex({0.5, 0.5, 0.5}), r = b.vertex({1, 1, 1});
  b.triangle(p, q, r);  // on one line
  b.triangle(p, p, r);  // a vertex twice
  b.triangle(p, b.vertex({-0.0, 0, -0.0}), r);
  b.triangle(p, b.vertex({kNaN, 0, 0}), r);
  b.triangle(p, b.vertex({0, HUGE_VAL, 0}), r);
  b.triangle(p, b.vertex({0, 1e200, 0}), b.vertex({0, 0, 1e200}));  // its normal is beyond double
  EXPECT_EQ(b.given(), 18u);
  EXPECT_EQ(b.dropped(), (MeshDropped{3, 3}));
  const auto mesh = finished(b);
  EXPECT_EQ(mesh->vertices().size(), 8u);  // what only dropped triangles used is gone
  EXPECT_EQ(mesh->triangles().size(), 12u);
  EXPECT_EQ(mesh->highest(), MeshPoint(1, 1, 1));
  for (const Triangle& t : mesh->triangles()) {
    const MeshVec n = normalize(mesh->normalTimesTwiceArea(t));
    EXPECT_NEAR(length(n), 1, 1e-12);
  }
  EXPECT_TRUE(meshFacts(*mesh).closed);
}

TEST(Mesh, WithoutATriangleThereIsNoMesh) {
  MeshBuilder b;
  b.triangle(b.vertex({0, 0, 0}), b.vertex({1, 0, 0}), b.vertex({2, 0, 0}));
  const auto mesh = b.finish();
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().code, ErrorCode::NothingToLoad);
}

TEST(Mesh, ManyVerticesWeldToThoseThatDiffer) {
  MeshBuilder b;
  constexpr int n = 200;  // 80,000 triangles that bring three vertices each
  const auto p = [](int i, int j) { return glm::dvec3(0.1 * i, 0.1 * j, std::sin(0.01 * i * j)); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) addQuad(b, p(i, j), p(i + 1, j), p(i + 1, j + 1), p(i, j + 1));
  const auto mesh = finished(b);
  EXPECT_EQ(mesh->vertices().size(), static_cast<std::size_t>((n + 1) * (n + 1)));
  EXPECT_EQ(meshFacts(*mesh).edgesUsedOnce, 4u * n);
}

}  // namespace
}  // namespace vernier::test
