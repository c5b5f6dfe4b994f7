// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/base/Frames.h"

#include <gtest/gtest.h>

#include "vernier/base/Checked.h"
#include "vernier/base/GridGeometry.h"
#include "vernier/base/HalfSpace.h"
#include "vernier/base/Random.h"
#include "vernier/base/Units.h"

namespace vernier {
namespace {

TEST(Frames, InverseUndoesAnObliqueShearedLeftHandedMap) {
  PatientFromVoxel m;
  m.linear = glm::dmat3(glm::dvec3(0.4, 0.1, 0), glm::dvec3(-0.1, 0.5, 0.02), glm::dvec3(0.3, 0.1, -2.5));
  m.translation = {-120, 33.5, 1000.25};
  const VoxelPoint v(3.25, 100, 7.5);
  const VoxelPoint back = m.inverse() * (m * v);
  EXPECT_NEAR(glm::length(back.p - v.p), 0, 1e-11);
  const auto identity = m.inverse() * m;
  EXPECT_NEAR(identity.linear[2][1], 0, 1e-14);
}

TEST(Frames, TransformsComposeTargetFirst) {
  PatientFromVoxel a{glm::dmat3(2.0), {1, 0, 0}};
  Transform<VoxelFrame, TextureFrame> b{glm::dmat3(10.0), {-0.5, -0.5, -0.5}};
  const Point<TextureFrame> t(0.5, 0.5, 0.5);
  EXPECT_EQ((a * b * t), (a * (b * t)));
}

TEST(HalfSpace, OutsideIsPositive) {
  const HalfSpace h{PatientVec(0, 0, 1), 5};
  EXPECT_TRUE(h.contains(PatientPoint(9, 9, 5)));
  EXPECT_DOUBLE_EQ(h.distance_mm(PatientPoint(0, 0, 7)), 2);
}

TEST(Units, DegreesAndRadians) { EXPECT_DOUBLE_EQ(Degrees(Radians(Degrees(90))).deg, 90); }

TEST(Checked, SaysWhenItOverflows) {
  EXPECT_EQ(checkedProduct({65535, 65535, 4}), 65535ull * 65535 * 4);
  EXPECT_FALSE(checkedProduct({1ull << 40, 1ull << 30}));
  EXPECT_FALSE(checkedAdd(~0ull, 1));
}

TEST(Random, DrawsDependOnSeedAndCounterOnly) {
  EXPECT_EQ(randomBits(1, 5), randomBits(1, 5));
  EXPECT_NE(randomBits(1, 5), randomBits(2, 5));
  double sum = 0;
  for (int i = 0; i < 100000; ++i) sum += randomUnit(42, static_cast<std::uint64_t>(i));
  EXPECT_NEAR(sum / 100000, 0.5, 0.005);
}

TEST(GridGeometry, CornersAndSpacing) {
  GridGeometry g;
  g.columns = 11, g.rows = 21, g.slices = 5;
  g.patientFromVoxel.linear = glm::dmat3(glm::dvec3(0.5, 0, 0), glm::dvec3(0, 0.25, 0), glm::dvec3(0, 1, 2));
  EXPECT_EQ(g.corner(7), PatientPoint(5, 9, 8));
  EXPECT_EQ(g.spacing_mm(), glm::dvec3(0.5, 0.25, 2));  // along the normal, not along the sheared column
}

}  // namespace
}  // namespace vernier
