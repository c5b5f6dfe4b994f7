// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Outline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vernier {
namespace {

TEST(Outline, ALineIsWhereItsEndsSayAndNowhereElse) {
  Picture p(60, 40, {100, 100, 100});
  const LineSegment line{{10.5, 5.5}, {50.5, 30.5}};
  drawLines(p, std::vector{line}, {1, 0.5, 0}, 2);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x) {
      const glm::dvec2 q(x + 0.5, y + 0.5), along = line.b - line.a;
      const double t = std::clamp(glm::dot(q - line.a, along) / glm::dot(along, along), 0.0, 1.0);
      const double d = glm::length(q - line.a - t * along);
      const std::uint8_t* c = p.at(x, y);
      if (d <= 0.5) {
        EXPECT_EQ(c[0], 255) << x << " " << y;
        EXPECT_EQ(c[1], 128);
        EXPECT_EQ(c[2], 0);
      }
      if (d >= 2.5) {
        EXPECT_EQ(c[0], 100) << x << " " << y;
      }
      if (d > 1.6 && d < 2.0) {
        EXPECT_LT(c[0], 100) << x << " " << y;  // the seam
      }
    }
}

TEST(Outline, ManySegmentsBlendAPixelOnce) {
  Picture once(30, 30, {200, 200, 200}), often = once;
  const LineSegment line{{5, 15}, {25, 15}};
  drawLines(once, std::vector{line}, {0, 1, 0}, 2, 0.5);
  std::vector<LineSegment> parts(50, line);
  for (int i = 0; i < 40; ++i) parts.push_back({{5 + 0.5 * i, 15}, {5.5 + 0.5 * i, 15}});
  drawLines(often, parts, {0, 1, 0}, 2, 0.5);
  EXPECT_EQ(once, often);
}

TEST(Outline, FarAndBrokenLinesCostNothingAndHarmNothing) {
  Picture p(30, 30, {9, 9, 9}), expected = p;
  drawLines(expected, std::vector{LineSegment{{-100, 15.5}, {100, 15.5}}}, {1, 1, 1}, 1);
  drawLines(p,
            std::vector{LineSegment{{-1e12, 15.5}, {1e12, 15.5}}, LineSegment{{std::nan(""), 0}, {1, 1}},
                        LineSegment{{HUGE_VAL, 0}, {1, 1}}, LineSegment{{-50, -50}, {-50, 80}}},
            {1, 1, 1}, 1);
  EXPECT_EQ(p, expected);
  Picture none;
  drawLines(none, std::vector{LineSegment{{0, 0}, {1, 1}}}, {1, 1, 1}, 1);
}

// A box of 20 x 10 mm on a slice of 0.5 mm pixels: the outline's corners lie where the slice has those
// points.
TEST(Outline, TheOutlineLiesWhereTheSlicesPixelsAre) {
  MeshBuilder b;
  const auto at = [&](int n) {
    return b.vertex({n & 1 ? 20.0 : 0.0, n & 2 ? 10.0 : 0.0, n & 4 ? 30.0 : 0.0});
  };
  constexpr int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                               {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    b.triangle(at(q[0]), at(q[1]), at(q[2]));
    b.triangle(at(q[0]), at(q[2]), at(q[3]));
  }
  const auto mesh = *b.finish();
  SurfaceLayer surface;
  surface.pose.translation = {5, 6, 0};
  SliceLayer slice;
  slice.plane.point = PatientPoint(0, 0, 15);
  SlicePicture picture;
  picture.origin = PatientPoint(-10, -10, 15);
  picture.right = PatientVec(0.5, 0, 0), picture.down = PatientVec(0, 0.5, 0);
  picture.normal = PatientVec(0, 0, -1), picture.mmPerPixel = 0.5;
  glm::dvec2 low(1e9), high(-1e9);
  double sum = 0;
  for (const LineSegment& s : outlineOf(surface, *mesh, slice, picture)) {
    low = glm::min(low, glm::min(s.a, s.b)), high = glm::max(high, glm::max(s.a, s.b));
    sum += glm::length(s.b - s.a);
  }
  EXPECT_NEAR(low.x, 30, 1e-9);
  EXPECT_NEAR(low.y, 32, 1e-9);
  EXPECT_NEAR(high.x, 70, 1e-9);
  EXPECT_NEAR(high.y, 52, 1e-9);
  EXPECT_NEAR(sum, 120, 1e-9);
}

}  // namespace
}  // namespace vernier
