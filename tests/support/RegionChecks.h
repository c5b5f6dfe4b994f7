// SPDX-License-Identifier: GPL-3.0-or-later
// What must hold of any ConvexRegion, each by its definition and in long double.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "vernier/base/ConvexRegion.h"

namespace vernier::test {

using Long3 = std::array<long double, 3>;
inline Long3 toLong(const glm::dvec3& p) { return {p.x, p.y, p.z}; }
inline Long3 minus(const Long3& a, const Long3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Long3 cross(const Long3& a, const Long3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline long double dot(const Long3& a, const Long3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// By tetrahedra from the first corner: above 0 when triangles are counterclockwise from outside.
inline double volumeOf(const ConvexRegion& r) {
  const Long3 o = toLong(r.corners.at(0).p);
  long double six = 0;
  for (const auto& t : r.triangles) {
    Long3 c[3];
    for (int k = 0; k < 3; ++k) c[k] = minus(toLong(r.corners.at(t[k]).p), o);
    six += dot(c[0], cross(c[1], c[2]));
  }
  return static_cast<double>(six / 6);
}

inline double sizeOf(const ConvexRegion& r) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const PatientPoint& p : r.corners) low = glm::min(low, p.p), high = glm::max(high, p.p);
  return glm::length(high - low);
}

// Each edge once in each direction, each corner in use, V - E + F = 2.
inline void expectClosed(const ConvexRegion& r) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::vector<bool> used(r.corners.size());
  for (const auto& t : r.triangles)
    for (int k = 0; k < 3; ++k) {
      ASSERT_LT(t[k], r.corners.size());
      used[t[k]] = true;
      EXPECT_TRUE(edges.emplace(t[k], t[(k + 1) % 3]).second) << "an edge twice in one direction";
    }
  std::size_t alone = 0;
  for (const auto& [a, b] : edges) alone += !edges.contains({b, a});
  EXPECT_EQ(alone, 0u) << "edges without their opposite";
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  EXPECT_EQ(static_cast<long>(r.corners.size()) - static_cast<long>(edges.size() / 2) +
                static_cast<long>(r.triangles.size()),
            2);
}

// Unit normals, each plane in use and none twice, corners within all planes (their own ones bit by bit) and
// on their own to `tolerance`, triangles turned outwards.
inline void expectPlanes(const ConvexRegion& r, double tolerance) {
  ASSERT_EQ(r.planeOf.size(), r.triangles.size());
  std::set<std::array<double, 4>> different;
  for (const HalfSpace& h : r.planes) {
    EXPECT_NEAR(glm::length(h.normal.v), 1, 1e-15);
    different.insert({h.normal.v.x, h.normal.v.y, h.normal.v.z, h.offset_mm});
  }
  EXPECT_EQ(different.size(), r.planes.size());
  std::set<std::uint32_t> used(r.planeOf.begin(), r.planeOf.end());
  EXPECT_EQ(used.size(), r.planes.size());
  double off = 0, outside = 0;
  std::size_t notHeld = 0, inwards = 0;
  for (std::size_t n = 0; n < r.triangles.size(); ++n) {
    const HalfSpace& h = r.planes.at(r.planeOf[n]);
    Long3 c[3];
    for (int k = 0; k < 3; ++k) {
      const PatientPoint& p = r.corners[r.triangles[n][k]];
      c[k] = toLong(p.p);
      off = std::max(off, std::abs(h.distance_mm(p)));
      notHeld += !h.contains(p);
    }
    inwards += dot(cross(minus(c[1], c[0]), minus(c[2], c[0])), toLong(h.normal.v)) <= 0;
  }
  for (const HalfSpace& h : r.planes)
    for (const PatientPoint& p : r.corners) outside = std::max(outside, h.distance_mm(p));
  EXPECT_LE(off, tolerance);
  EXPECT_LE(outside, tolerance);
  EXPECT_EQ(notHeld, 0u);
  EXPECT_EQ(inwards, 0u);
}

// Corners rounded to float32 from the middle of their box: triangles that face inwards then.
inline std::size_t invertedInFloat(const ConvexRegion& r) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const PatientPoint& p : r.corners) low = glm::min(low, p.p), high = glm::max(high, p.p);
  const glm::dvec3 middle = 0.5 * (low + high);
  std::size_t inverted = 0;
  for (std::size_t n = 0; n < r.triangles.size(); ++n) {
    Long3 c[3];
    for (int k = 0; k < 3; ++k) c[k] = toLong(glm::dvec3(glm::vec3(r.corners[r.triangles[n][k]].p - middle)));
    inverted +=
        dot(cross(minus(c[1], c[0]), minus(c[2], c[0])), toLong(r.planes[r.planeOf[n]].normal.v)) <= 0;
  }
  return inverted;
}

inline void expectRegion(const ConvexRegion& r, double tolerance) {
  expectClosed(r);
  expectPlanes(r, tolerance);
  EXPECT_GT(volumeOf(r), 0);
  EXPECT_EQ(invertedInFloat(r), 0u);
}

}  // namespace vernier::test
