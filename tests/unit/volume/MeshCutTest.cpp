// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/MeshCut.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace vernier::test {
namespace {

std::shared_ptr<const Mesh> box(glm::dvec3 low, glm::dvec3 high) {
  MeshBuilder b;
  const auto at = [&](int n) {
    return b.vertex({n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z});
  };
  constexpr int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                               {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    b.triangle(at(q[0]), at(q[1]), at(q[2]));
    b.triangle(at(q[0]), at(q[2]), at(q[3]));
  }
  return *b.finish();
}

std::shared_ptr<const Mesh> torus(double large, double small, int n) {
  MeshBuilder b;
  const auto at = [&](int i, int j) {
    const double u = 2 * std::numbers::pi * (i % n) / n, v = 2 * std::numbers::pi * (j % n) / n;
    return b.vertex({(large + small * std::cos(v)) * std::cos(u), (large + small * std::cos(v)) * std::sin(u),
                     small * std::sin(v)});
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      b.triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      b.triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return *b.finish();
}

double lengthOf(const std::vector<CutSegment>& segments) {
  double sum = 0;
  for (const CutSegment& s : segments) sum += length(s.b - s.a);
  return sum;
}

// Every end is the end of exactly one other segment, bit by bit.
void expectClosed(const std::vector<CutSegment>& segments) {
  std::map<std::array<double, 3>, int> ends;
  for (const CutSegment& s : segments)
    for (const PatientPoint& p : {s.a, s.b}) ++ends[{p.p.x, p.p.y, p.p.z}];
  for (const auto& [place, n] : ends) EXPECT_EQ(n % 2, 0) << place[0] << " " << place[1] << " " << place[2];
}

TEST(MeshCut, ABoxIsCutToARectangle) {
  const auto mesh = box({0, 0, 0}, {10, 20, 30});
  const auto segments = cutMesh(*mesh, {}, PatientPoint(0, 0, 12), PatientVec(0, 0, 3));
  EXPECT_NEAR(lengthOf(segments), 60, 1e-12);
  expectClosed(segments);
  for (const CutSegment& s : segments)
    for (const PatientPoint& p : {s.a, s.b}) {
      EXPECT_NEAR(p.p.z, 12, 1e-12);
      EXPECT_TRUE(p.p.x == 0 || p.p.x == 10 || p.p.y == 0 || p.p.y == 20);
    }
  EXPECT_TRUE(cutMesh(*mesh, {}, PatientPoint(0, 0, 31), PatientVec(0, 0, 1)).empty());
}

// Through vertices and along faces: closed, and on one side only.
TEST(MeshCut, PlanesThroughVerticesLeaveNoLooseEnds) {
  const auto mesh = box({0, 0, 0}, {10, 20, 30});
  for (const double z : {0.0, 30.0}) {
    const auto segments = cutMesh(*mesh, {}, PatientPoint(0, 0, z), PatientVec(0, 0, 1));
    expectClosed(segments);
    EXPECT_NEAR(lengthOf(segments), z == 30 ? 60 : 0, 1e-12);
  }
  const auto diagonal = cutMesh(*mesh, {}, PatientPoint(0, 0, 0), PatientVec(2, -1, 0));
  expectClosed(diagonal);
  EXPECT_NEAR(lengthOf(diagonal), 2 * (std::sqrt(500.0) + 30), 1e-9);
}

TEST(MeshCut, ATorusIsCutToTwoCircles) {
  const auto mesh = torus(20, 6, 180);
  // Across: two circles of the tube; through the middle: the outer and the inner circle.
  const auto across = cutMesh(*mesh, {}, PatientPoint(0, 1e-3, 0), PatientVec(0, 1, 0));
  EXPECT_NEAR(lengthOf(across), 2 * 2 * std::numbers::pi * 6, 0.05);
  expectClosed(across);
  const auto through = cutMesh(*mesh, {}, PatientPoint(0, 0, 1e-3), PatientVec(0, 0, 1));
  EXPECT_NEAR(lengthOf(through), 2 * std::numbers::pi * (26 + 14), 0.1);
  expectClosed(through);
}

TEST(MeshCut, TheCutOfAPosedSurfaceIsThePosedCut) {
  const auto mesh = torus(20, 6, 60);
  PatientFromMesh pose;
  pose.linear = glm::dmat3({0, 0, 1}, {1, 0, 0}, {0, 1, 0});
  pose.translation = {100, -50, 25};
  const auto plain = cutMesh(*mesh, {}, PatientPoint(1, 2, 0.7), PatientVec(0.1, 0.2, 1));
  const auto posed = cutMesh(*mesh, pose, pose * MeshPoint(1, 2, 0.7), pose * MeshVec(0.1, 0.2, 1));
  ASSERT_EQ(plain.size(), posed.size());
  EXPECT_GT(plain.size(), 100u);
  for (std::size_t i = 0; i < plain.size(); ++i)
    EXPECT_LE(length(posed[i].a - pose * MeshPoint(plain[i].a.p)), 1e-12);
}

}  // namespace
}  // namespace vernier::test
