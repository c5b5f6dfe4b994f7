// SPDX-License-Identifier: GPL-3.0-or-later
// Order and fit of hand-made positions, against closed forms.
#include "StackGeometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace vernier {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<FramePlane> axialPlanes(const std::vector<glm::dvec3>& origins) {
  std::vector<FramePlane> planes;
  for (const glm::dvec3& o : origins)
    planes.push_back({PatientPoint(o), PatientVec(1, 0, 0), PatientVec(0, 1, 0)});
  return planes;
}
Stack fit(const std::vector<FramePlane>& planes, glm::dvec2 spacing = {1, 1}) {
  Stack s;
  fitGeometry(planes, 10, 20, spacing, s);
  return s;
}
const Finding* finding(const Stack& s, const std::string& code) {
  for (const Finding& f : s.findings)
    if (f.code == code) return &f;
  return nullptr;
}
double numberOf(const Finding& f, const char* key) { return std::get<double>(f.numbers.at(key)); }
void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  EXPECT_NEAR(glm::length(a - b), 0, tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(StackGeometry, EvenStackMapsVoxelsToPatient) {
  // 2:1 pixels: spacing is row\column, so columns are 0.5 mm apart and rows 2 mm.
  const Stack s = fit(axialPlanes({{10, 20, 30}, {10, 20, 33}, {10, 20, 36}}), {2, 0.5});
  EXPECT_EQ(s.shape, StackShape::Uniform);
  EXPECT_TRUE(s.volume3d);
  EXPECT_TRUE(s.findings.empty());
  EXPECT_NEAR(s.step_mm, 3, 1e-12);
  EXPECT_EQ(s.grid.columns, 20);
  EXPECT_EQ(s.grid.rows, 10);
  EXPECT_EQ(s.grid.slices, 3);
  EXPECT_TRUE(s.grid.even());
  expectNear((s.grid.patientFromVoxel * VoxelPoint(4, 3, 2)).p, {12, 26, 36}, 1e-12);
}

TEST(StackGeometry, ObliqueStackKeepsItsDirections) {
  const double a = 0.3, b = 0.7;
  const glm::dvec3 row{std::cos(a), std::sin(a), 0};
  const glm::dvec3 column{-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)};
  const glm::dvec3 n = glm::cross(row, column);
  std::vector<FramePlane> planes;
  for (int k = 0; k < 5; ++k)
    planes.push_back(
        {PatientPoint(glm::dvec3(-100, 7, 900) + 1.25 * k * n), PatientVec(row), PatientVec(column)});
  const Stack s = fit(planes, {0.8, 0.7});
  ASSERT_EQ(s.shape, StackShape::Uniform);
  EXPECT_NEAR(s.step_mm, 1.25, 1e-12);
  const glm::dvec3 expected = glm::dvec3(-100, 7, 900) + 5 * 0.7 * row + 6 * 0.8 * column + 4 * 1.25 * n;
  expectNear((s.grid.patientFromVoxel * VoxelPoint(5, 6, 4)).p, expected, 1e-10);
  EXPECT_LT(s.shear_deg, 1e-9);
}

TEST(StackGeometry, OrderIsAlongTheNormalAndNothingElse) {
  std::vector<SlicePlane> slices;
  for (const double z : {5.0, -1.0, 3.0, 3.0}) {
    slices.push_back({axialPlanes({{0, 0, z}})[0], static_cast<std::int64_t>(10 - slices.size())});
  }
  EXPECT_EQ(orderAlongNormal(slices), (std::vector<std::size_t>{1, 3, 2, 0}));  // equal places by their tie
  // The normal turns round with the column direction, and so does the order.
  for (SlicePlane& s : slices) s.plane.columnDirection = PatientVec(0, -1, 0);
  EXPECT_EQ(orderAlongNormal(slices), (std::vector<std::size_t>{0, 3, 2, 1}));
}

TEST(StackGeometry, TiltIsAShearedAffineWithTheSlicesWhereTheyWere) {
  const double tilt = 14 * kPi / 180, d = 5;
  std::vector<glm::dvec3> origins;
  for (int k = 0; k < 4; ++k) origins.push_back({1, 2 - k * d * std::sin(tilt), 3 + k * d * std::cos(tilt)});
  const Stack s = fit(axialPlanes(origins));
  EXPECT_EQ(s.shape, StackShape::Sheared);
  EXPECT_TRUE(s.volume3d);
  EXPECT_TRUE(s.grid.even());
  EXPECT_NEAR(s.shear_deg, 14, 1e-9);
  EXPECT_NEAR(s.step_mm, d * std::cos(tilt), 1e-12);
  for (int k = 0; k < 4; ++k)
    expectNear((s.grid.patientFromVoxel * VoxelPoint(0, 0, k)).p, origins[static_cast<std::size_t>(k)],
               1e-10);
  const Finding* f = finding(s, "tilt");
  ASSERT_TRUE(f);
  EXPECT_NEAR(numberOf(*f, "along_column_axis_deg"), -14, 1e-9);
  EXPECT_NEAR(numberOf(*f, "along_row_axis_deg"), 0, 1e-9);
  EXPECT_NEAR(numberOf(*f, "distance_between_origins_mm"), d, 1e-12);
}

TEST(StackGeometry, ShearBelowATenthOfADegreeIsNoTilt) {
  const auto sheared = [](double deg) {
    std::vector<glm::dvec3> o;
    for (int k = 0; k < 4; ++k) o.push_back({k * std::tan(deg * kPi / 180), 0, static_cast<double>(k)});
    return fit(axialPlanes(o));
  };
  EXPECT_EQ(sheared(0.099).shape, StackShape::Uniform);
  EXPECT_EQ(sheared(0.101).shape, StackShape::Sheared);
  EXPECT_TRUE(finding(sheared(0.101), "tilt"));
  EXPECT_FALSE(finding(sheared(0.099), "tilt"));
}

// Five slices of which the middle one is off by d along the normal: the fitted line moves by d/5, so e = 4/5
// d.
Stack middleOff(double d_mm, double step_mm, double pixel_mm) {
  std::vector<glm::dvec3> o;
  for (int k = 0; k < 5; ++k) o.push_back({0, 0, k * step_mm + (k == 2 ? d_mm : 0)});
  return fit(axialPlanes(o), {pixel_mm, pixel_mm});
}

TEST(StackGeometry, DeviationIsTheDistanceFromTheFittedLine) {
  const Stack s = middleOff(0.1, 10, 1);
  EXPECT_NEAR(s.deviation_mm, 0.08, 1e-12);
  EXPECT_NEAR(s.deviationAlongNormal_mm, 0.08, 1e-12);
  EXPECT_NEAR(s.step_mm, 10, 0.051);  // the median of 10, 10.1, 9.9, 10
}

TEST(StackGeometry, UniformUpToTwoPercentOfTheStepAndAQuarterPixel) {
  // e <= 0.02 x step: the step is 5, so e up to 0.1 mm, d up to 0.125.
  EXPECT_EQ(middleOff(0.1249, 5, 1).shape, StackShape::Uniform);
  EXPECT_EQ(middleOff(0.1260, 5, 1).shape, StackShape::Uneven);
  // e <= 0.25 x pixel spacing: 0.05 mm for pixels of 0.2 mm, d up to 0.0625.
  EXPECT_EQ(middleOff(0.0624, 5, 0.2).shape, StackShape::Uniform);
  EXPECT_EQ(middleOff(0.0626, 5, 0.2).shape, StackShape::Uneven);
  // The harmless deviation is told as info, the other one changes what is seen.
  ASSERT_TRUE(finding(middleOff(0.1, 5, 1), "uneven-spacing"));
  EXPECT_EQ(finding(middleOff(0.1, 5, 1), "uneven-spacing")->severity, Severity::Info);
  EXPECT_EQ(finding(middleOff(0.2, 5, 1), "uneven-spacing")->severity, Severity::Warning);
  EXPECT_FALSE(finding(middleOff(1e-4, 5, 1), "uneven-spacing"));
}

TEST(StackGeometry, UnevenStackKeepsTheTruePlaceOfEachSlice) {
  const std::vector<glm::dvec3> origins{{0, 0, 0}, {0.3, 0, 2}, {0, 0, 5}, {0, 0.2, 7}, {0, 0, 10}};
  const Stack s = fit(axialPlanes(origins), {0.5, 0.5});
  ASSERT_EQ(s.shape, StackShape::Uneven);
  EXPECT_TRUE(s.volume3d);
  EXPECT_TRUE(s.grid.gapAfter.empty());
  ASSERT_EQ(s.grid.sliceOrigin_vox.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    expectNear((s.grid.patientFromVoxel * VoxelPoint(s.grid.sliceOrigin_vox[k])).p, origins[k], 1e-12);
    EXPECT_GT(s.grid.sliceOrigin_vox[k].z, k > 0 ? s.grid.sliceOrigin_vox[k - 1].z : -1.0);
  }
}

TEST(StackGeometry, GapIsKeptOpenAndTheSlicesBehindItStayInPlace) {
  // The middle of nine slices is missing.
  std::vector<glm::dvec3> origins;
  for (const double k : {0.0, 1.0, 2.0, 3.0, 5.0, 6.0, 7.0, 8.0}) origins.push_back({0, 0, 100 + 2.5 * k});
  const Stack s = fit(axialPlanes(origins));
  EXPECT_EQ(s.shape, StackShape::Uneven);
  EXPECT_TRUE(s.volume3d);
  EXPECT_EQ(s.grid.gapAfter, (std::vector<std::int64_t>{3}));
  EXPECT_NEAR(s.deviation_mm, 0, 1e-12);
  ASSERT_EQ(s.grid.sliceOrigin_vox.size(), 8u);
  EXPECT_NEAR(s.grid.sliceOrigin_vox[7].z, 8, 1e-12);
  expectNear((s.grid.patientFromVoxel * VoxelPoint(s.grid.sliceOrigin_vox[7])).p, {0, 0, 120}, 1e-12);
  const Finding* f = finding(s, "gap");
  ASSERT_TRUE(f);
  EXPECT_EQ(std::get<std::vector<double>>(f->numbers.at("at_mm")), (std::vector<double>{107.5, 112.5}));
  EXPECT_EQ(numberOf(*f, "missing_slices"), 1);
  EXPECT_FALSE(finding(s, "uneven-spacing"));
}

TEST(StackGeometry, GapBeginsAboveOneAndAHalfSteps) {
  const auto lastStep = [](double step) {
    return fit(axialPlanes({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 3 + step}}));
  };
  EXPECT_TRUE(lastStep(1.5).grid.gapAfter.empty());
  EXPECT_EQ(lastStep(1.51).grid.gapAfter.size(), 1u);
}

TEST(StackGeometry, CoincidentPositionsRefuse3d) {
  const Stack s = fit(axialPlanes({{0, 0, 0}, {0, 0, 1}, {0, 0, 1.00005}, {0, 0, 2}}));
  EXPECT_FALSE(s.volume3d);
  ASSERT_TRUE(finding(s, "coincident-positions"));
  EXPECT_EQ(finding(s, "coincident-positions")->severity, Severity::Refusal);
  EXPECT_FALSE(s.why2d.empty());
  EXPECT_TRUE(fit(axialPlanes({{0, 0, 0}, {0, 0, 1}, {0, 0, 1.0002}, {0, 0, 2}})).volume3d ||
              !fit(axialPlanes({{0, 0, 0}, {0, 0, 1}, {0, 0, 1.0002}, {0, 0, 2}})).grid.gapAfter.empty());
}

TEST(StackGeometry, SingleAndPair) {
  const Stack one = fit(axialPlanes({{1, 2, 3}}));
  EXPECT_EQ(one.shape, StackShape::Single);
  EXPECT_FALSE(one.volume3d);
  EXPECT_FALSE(one.why2d.empty());
  EXPECT_NE(glm::determinant(one.grid.patientFromVoxel.linear), 0);
  const Stack two = fit(axialPlanes({{1, 2, 3}, {1, 2, 8}}));
  EXPECT_EQ(two.shape, StackShape::Uniform);
  EXPECT_TRUE(two.volume3d);
  EXPECT_NEAR(two.step_mm, 5, 1e-12);
  expectNear((two.grid.patientFromVoxel * VoxelPoint(0, 0, 1)).p, {1, 2, 8}, 1e-12);
}

TEST(StackGeometry, LeftHandedDirectionsAreKept) {
  std::vector<FramePlane> planes;
  for (int k = 0; k < 3; ++k)
    planes.push_back({PatientPoint(0, 0, -2.0 * k), PatientVec(1, 0, 0), PatientVec(0, -1, 0)});
  const Stack s = fit(planes);
  ASSERT_TRUE(s.volume3d);
  // Columns run to the left, rows to anterior, slices downwards: a right-handed frame again, since the order
  // follows the normal; the flip of one axis is in the directions.
  expectNear(s.grid.patientFromVoxel.linear[1], {0, -1, 0}, 1e-12);
  expectNear(s.grid.patientFromVoxel.linear[2], {0, 0, -2}, 1e-12);
}

TEST(StackGeometry, UnusableSpacingRefuses3d) {
  const auto planes = axialPlanes({{0, 0, 0}, {0, 0, 1}});
  for (const double p : {0.0, -1.0, 1e-9, 1e6, std::nan("")}) {
    const Stack s = fit(planes, {1, p});
    EXPECT_EQ(s.shape, StackShape::NoGeometry) << p;
    EXPECT_FALSE(s.volume3d) << p;
    EXPECT_TRUE(finding(s, "pixel-spacing-unusable")) << p;
    EXPECT_EQ(s.positions_mm.size(), 2u);
  }
  EXPECT_TRUE(fit(planes, {1e-4, 1e3}).volume3d || fit(planes, {1e-4, 1e3}).shape == StackShape::Uneven);
}

TEST(StackGeometry, FarFromTheOriginNothingIsLost) {
  std::vector<glm::dvec3> near, far;
  for (int k = 0; k < 50; ++k) {
    near.push_back({0.1 * k, 0, 1.3 * k});
    far.push_back(near.back() + glm::dvec3(1e6, -1e6, 1e6));
  }
  const Stack a = fit(axialPlanes(near)), b = fit(axialPlanes(far));
  EXPECT_EQ(a.shape, b.shape);
  expectNear(a.grid.patientFromVoxel.linear[2], b.grid.patientFromVoxel.linear[2], 1e-9);
  EXPECT_LT(b.deviation_mm, 1e-8);
}

TEST(StackGeometry, GramSchmidtKeepsTheRow) {
  const auto p = orthonormalPlane({1, 2, 3}, {1.0001, 0, 0}, {0.005, 0.9999, 0});
  ASSERT_TRUE(p);
  expectNear(p->rowDirection.v, {1, 0, 0}, 1e-15);
  expectNear(p->columnDirection.v, {0, 1, 0}, 1e-12);
  EXPECT_FALSE(orthonormalPlane({0, 0, 0}, {0, 0, 0}, {0, 1, 0}));
  EXPECT_FALSE(orthonormalPlane({0, 0, 0}, {1, 0, 0}, {2, 0, 0}));
  EXPECT_FALSE(orthonormalPlane({0, 0, std::nan("")}, {1, 0, 0}, {0, 1, 0}));
  EXPECT_FALSE(orthonormalPlane({0, 0, 0}, {1, 0, INFINITY}, {0, 1, 0}));
}

}  // namespace
}  // namespace vernier
