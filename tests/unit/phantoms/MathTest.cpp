// SPDX-License-Identifier: GPL-3.0-or-later
// The generator's own arithmetic against the C library's.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "Plan.h"
#include "PortableMath.h"
#include "Solids.h"

namespace vernier::phantoms {
namespace {

TEST(PortableMath, AgreesWithTheLibraryToAFewLastPlaces) {
  for (int n = -4000; n <= 4000; ++n) {
    const double x = n * 0.0173;
    EXPECT_NEAR(portableSin(x), std::sin(x), 3e-15) << x;
    EXPECT_NEAR(portableCos(x), std::cos(x), 3e-15) << x;
    EXPECT_NEAR(portableExp(x) / std::exp(x), 1.0, 1e-14) << x;
  }
  EXPECT_EQ(portableExp(0.0), 1.0);
  EXPECT_EQ(portableSin(0.0), 0.0);
  EXPECT_EQ(portableCos(0.0), 1.0);
}

TEST(DecimalString, IsShortExactWhereItCanBeAndNeverLongerThan16) {
  EXPECT_EQ(dsOf(0.45), "0.45");
  EXPECT_EQ(dsOf(-31.5), "-31.5");
  EXPECT_EQ(dsOf(0.0), "0");
  EXPECT_EQ(dsOf(-1e-30), "0");
  for (int n = 1; n < 500; ++n) {
    const double v = std::sin(n * 0.731) * std::pow(10.0, n % 6 - 2);
    const std::string text = dsOf(v);
    EXPECT_LE(text.size(), 16u) << text;
    EXPECT_NEAR(std::strtod(text.c_str(), nullptr), v, std::fabs(v) < 1 ? 1e-13 : 1e-9) << text;
    EXPECT_EQ(dsRounded(v), std::strtod(text.c_str(), nullptr));
  }
}

TEST(Uid, LiesUnder225AndDiffersByNameSeedAndRole) {
  std::set<std::string> all;
  for (const char* name : {"a", "b"})
    for (std::uint64_t seed : {1u, 2u})
      for (const char* role : {"study", "series 0", "image 1", "image 11"}) {
        const std::string uid = uidOf(name, seed, role);
        EXPECT_TRUE(uid.starts_with("2.25."));
        EXPECT_NE(uid[5], '0');
        EXPECT_LE(uid.size(), 5u + 39u);
        all.insert(uid);
      }
  EXPECT_EQ(all.size(), 16u);
  EXPECT_EQ(uidOf("a", 1, "study"), uidOf("a", 1, "study"));
}

// Rows are painted by intervals; the truth is the distance at every voxel.
TEST(Solids, PaintedRowsEqualTheDistanceAtEveryVoxel) {
  for (const Shape shape : {Shape::Ellipsoid, Shape::Box, Shape::Cylinder, Shape::Capsule}) {
    Solid s;
    s.shape = shape;
    s.centre_mm = {3, -2, 5};
    s.size_mm = shape == Shape::Capsule ? glm::dvec3(3, 5, 8) : glm::dvec3(9, 4, 6);
    s.patientFromLocal = rotationOf({20, -35, 50});
    s.clips.push_back({glm::normalize(glm::dvec3(1, 2, -1)), 2.0});
    s.value = 100;
    for (const double edge_mm : {0.0, 1.3}) {
      double painted = 0;
      for (int row = 0; row < 900; ++row) {
        RowLine line{{-20, -15 + (row % 30), -12 + (row / 30)}, {0.8, 0.13, -0.07}, 60};
        std::vector<double> value(60, -7.0), noise(60, 0.0);
        paintRow(s, line, edge_mm, 1, value, noise);
        for (int i = 0; i < 60; ++i) {
          const double d = signedDistance(s, line.start_mm + static_cast<double>(i) * line.step_mm);
          const double cover = edge_mm > 0 ? std::clamp(0.5 - d / edge_mm, 0.0, 1.0) : d <= 0 ? 1.0 : 0.0;
          ASSERT_NEAR(value[static_cast<std::size_t>(i)], -7.0 + 107.0 * cover, 1e-9)
              << static_cast<int>(shape) << ' ' << row << ' ' << i;
          painted += cover;
        }
      }
      EXPECT_GT(painted, 100.0);
    }
  }
}

}  // namespace
}  // namespace vernier::phantoms
