// SPDX-License-Identifier: GPL-3.0-or-later
// The reference against a second evaluation that shares nothing with it: 10,000 small steps along each of 100
// rays, in long double, on random grids with uneven slices, gaps and no-data.
#include <cmath>

#include "BruteField.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

struct Truth {
  Real max = -1e30L, min = 1e30L, mean = 0;
  int valid = 0;
};

Truth bruteLine(const Volume& v, glm::dvec3 a_mm, glm::dvec3 b_mm) {
  const glm::dvec3 a = (v.voxelFromPatient() * PatientPoint(a_mm)).p,
                   b = (v.voxelFromPatient() * PatientPoint(b_mm)).p;
  constexpr int steps = 10000;
  Truth t;
  for (int n = 0; n < steps; ++n) {
    const Real u = (n + 0.5L) / steps;
    const Real value = bruteValue(v, a.x + u * (b.x - a.x), a.y + u * (b.y - a.y), a.z + u * (b.z - a.z));
    if (std::isnan(value)) continue;
    t.max = std::fmax(t.max, value);
    t.min = std::fmin(t.min, value);
    t.mean += value;
    ++t.valid;
  }
  if (t.valid) t.mean /= t.valid;
  return t;
}

TEST(BruteForce, HundredRays) {
  int compared = 0;
  for (std::uint64_t ray = 0; ray < 100; ++ray) {
    const std::uint64_t kind = ray % 4;
    const auto v = randomVolume(kind);
    const auto draw = [&](std::uint64_t n) { return randomUnit(1000 + ray, n); };
    const glm::dvec3 centre_vox(3 * draw(0), 2 * draw(1), 4 * draw(2));
    const glm::dvec3 direction = glm::normalize(glm::dvec3(draw(3) - 0.5, draw(4) - 0.5, draw(5) - 0.5));
    const glm::dvec3 half = (0.3 + 3 * draw(6)) * direction;
    const glm::dvec3 c = (v->grid().patientFromVoxel * VoxelPoint(centre_vox)).p;
    const glm::dvec3 a = c - half, b = c + half;
    const Truth truth = bruteLine(*v, a, b);
    SCOPED_TRACE("ray " + std::to_string(ray) + " kind " + std::to_string(kind));
    const auto max = valueAlong(v, a, b, SlabMode::Max), min = valueAlong(v, a, b, SlabMode::Min),
               mean = valueAlong(v, a, b, SlabMode::Mean);
    // A ray that only grazes the data may differ in whether it has any.
    if (truth.valid < 5) continue;
    ASSERT_TRUE(max && min && mean);
    ++compared;
    // Steps of 1e-4 see an extremum up to the curvature within a step; at a border or next to no-data the
    // field may end with a slope.
    const double missed = 2e-3, slack = 1e-12;
    EXPECT_GE(max->value, static_cast<double>(truth.max) - slack);
    EXPECT_LE(max->value, static_cast<double>(truth.max) + missed);
    EXPECT_LE(min->value, static_cast<double>(truth.min) + slack);
    EXPECT_GE(min->value, static_cast<double>(truth.min) - missed);
    EXPECT_NEAR(mean->value, static_cast<double>(truth.mean), kind == 0 ? 1e-4 : 5e-4);
    const auto point = valueAt(v, PatientPoint(c));
    const glm::dvec3 q = (v->voxelFromPatient() * PatientPoint(c)).p;
    const Real value = bruteValue(*v, q.x, q.y, q.z);
    ASSERT_EQ(point.has_value(), !std::isnan(value));
    if (point) {
      EXPECT_NEAR(point->value, static_cast<double>(value), 1e-13);
    }
  }
  EXPECT_GT(compared, 90);
}

}  // namespace
}  // namespace vernier::quality
