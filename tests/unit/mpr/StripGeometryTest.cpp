// SPDX-License-Identifier: GPL-3.0-or-later
#include "StripGeometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "../volume/Grids.h"

namespace vernier::mpr {
namespace {
using vernier::test::everyGrid;
using vernier::test::unitGrid;

TEST(StripGeometry, TheDiagonalOfACubeIsARegularHexagon) {
  const GridGeometry g = unitGrid(10, 10, 10);
  // Through the centre 4.5, normal (1, 1, 1); the box has edges of 10 with its border.
  const glm::dvec3 right = glm::normalize(glm::dvec3(1, -1, 0)) * 0.1;
  const glm::dvec3 down = glm::normalize(glm::dvec3(1, 1, -2)) * 0.1;
  const VoxelPlane plane{glm::dvec3(4.5) - 100.0 * right - 100.0 * down, right, down};
  const Outline hexagon = crossSection(plane, g, 200, 200, {});
  EXPECT_EQ(hexagon.size(), 6u);
  const double side = 10 / std::sqrt(2.0);
  EXPECT_NEAR(areaOf(hexagon) * 0.01, 1.5 * std::sqrt(3.0) * side * side, 1e-3);
  for (const glm::dvec2& corner : hexagon)
    EXPECT_NEAR(glm::length(plane.at(corner) - glm::dvec3(4.5)), side, 1e-4);
}

TEST(StripGeometry, StripsTileTheCrossSectionOfAStackWithoutGaps) {
  for (const auto& [name, g] : everyGrid()) {
    SCOPED_TRACE(name);
    if (name == "gaps") continue;
    const VoxelPlane plane{{-1, 7, -1.2}, {0.05, -0.02, 0.06}, {0.03, -0.05, 0.02}};
    double sum = 0;
    for (const Strip& s : cutIntoStrips(plane, g, 160, 140, {})) {
      EXPECT_LT(s.part.lower, s.part.upper);
      for (const glm::dvec2& p : s.outline) {
        EXPECT_GE(plane.at(p).z, s.part.lower - 1e-9);
        EXPECT_LE(plane.at(p).z, s.part.upper + 1e-9);
      }
      sum += areaOf(s.outline);
    }
    const double whole = areaOf(crossSection(plane, g, 160, 140, {}));
    EXPECT_GT(whole, 1000);
    EXPECT_NEAR(sum, whole, 1e-6 * whole);
  }
}

TEST(StripGeometry, OnlyCrossedSlicesHaveStrips) {
  const GridGeometry g = unitGrid(20, 20, 100);
  // k runs from 40.2 to 43.7 across the picture.
  const auto strips = cutIntoStrips({{0, 0, 40.2}, {0.1, 0, 3.5 / 100}, {0, 0.1, 0}}, g, 100, 100, {});
  ASSERT_EQ(strips.size(), 4u);
  EXPECT_EQ(strips.front().part.first, 40);
  EXPECT_EQ(strips.back().part.second, 44);
}

TEST(StripGeometry, PlaneInASliceIsThatSliceAlone) {
  const GridGeometry g = unitGrid(20, 20, 100);
  for (const double k : {0.0, 57.0, 99.0, 57 + 1e-9, 57 - 1e-9}) {
    const auto strips = cutIntoStrips({{0, 0, k}, {0.1, 0, 0}, {0, 0.1, 0}}, g, 100, 100, {0.1, 1e-5});
    ASSERT_EQ(strips.size(), 1u) << k;
    EXPECT_EQ(strips[0].part.first, std::llround(k));
    EXPECT_EQ(strips[0].part.second, std::llround(k));
  }
  EXPECT_EQ(cutIntoStrips({{0, 0, 57.5}, {0.1, 0, 0}, {0, 0.1, 0}}, g, 100, 100, {0.1, 1e-5}).size(), 1u);
  EXPECT_TRUE(cutIntoStrips({{0, 0, 99.6}, {0.1, 0, 0}, {0, 0.1, 0}}, g, 100, 100, {0.1, 1e-5}).empty());
  EXPECT_TRUE(cutIntoStrips({{30, 0, 50}, {0.1, 0, 0}, {0, 0.1, 0}}, g, 100, 100, {0.1, 1e-5}).empty());
}

TEST(StripGeometry, AcrossAGapSlicesAreHeldForHalfAStep) {
  GridGeometry g = unitGrid(4, 4, 3);
  g.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 4}, {0, 0, 4.6}};
  g.gapAfter = {0, 1};  // the second gap is shorter than two half steps
  const auto parts = partsOf(g);
  ASSERT_EQ(parts.size(), 6u);
  EXPECT_NEAR(parts[1].upper, 0.5, 1e-5);
  EXPECT_NEAR(parts[2].lower, 3.5, 1e-5);
  EXPECT_NEAR(parts[3].upper, 4.3, 1e-12);
  EXPECT_NEAR(parts[4].lower, 4.3, 1e-12);
  for (std::size_t n = 1; n < parts.size(); ++n) {
    EXPECT_EQ(parts[n].first, parts[n].second);
    EXPECT_LE(parts[n - 1].upper, parts[n].lower);
  }
}

TEST(StripGeometry, OneSliceHasOnePart) {
  const auto parts = partsOf(unitGrid(5, 5, 1));
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_NEAR(parts[0].upper - parts[0].lower, 1.0, 1e-5);
}

}  // namespace
}  // namespace vernier::mpr
