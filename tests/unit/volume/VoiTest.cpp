// SPDX-License-Identifier: GPL-3.0-or-later
// The truth is the pseudo-code of PS3.3 C.11.2.1.2.1 and C.11.2.1.3, typed from the standard, for an output
// of 0..255.
#include "vernier/volume/Voi.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace vernier {
namespace {

double standardLinear(double x, double c, double w, double ymin, double ymax) {
  if (x <= c - 0.5 - (w - 1) / 2) return ymin;
  if (x > c - 0.5 + (w - 1) / 2) return ymax;
  return ((x - (c - 0.5)) / (w - 1) + 0.5) * (ymax - ymin) + ymin;
}
double standardLinearExact(double x, double c, double w, double ymin, double ymax) {
  if (x <= c - w / 2) return ymin;
  if (x > c + w / 2) return ymax;
  return ((x - c) / w + 0.5) * (ymax - ymin) + ymin;
}
double standardSigmoid(double x, double c, double w, double ymin, double ymax) {
  return (ymax - ymin) / (1 + std::exp(-4 * (x - c) / w)) + ymin;
}

VoiWindow window(double c, double w, VoiFunction f = VoiFunction::Linear) { return {c, w, f, ""}; }

TEST(Voi, LinearEqualsTheStandardOnAllIntegersAndHalves) {
  for (double c : {-600.0, 0.0, 0.5, 40.0, 1000.25})
    for (double w : {1.0, 2.0, 3.0, 80.0, 400.5, 4096.0})
      for (double x = -3000; x <= 3000; x += 0.5)
        ASSERT_NEAR(applyVoi(window(c, w), x) * 255, standardLinear(x, c, w, 0, 255), 1e-9)
            << c << " " << w << " " << x;
}

TEST(Voi, LinearExactEqualsTheStandard) {
  for (double c : {-600.0, 0.0, 0.5, 1000.25})
    for (double w : {1e-3, 0.91, 1.0, 2.0, 80.0, 4096.0})
      for (double x = -3000; x <= 3000; x += 0.5)
        ASSERT_NEAR(applyVoi(window(c, w, VoiFunction::LinearExact), x) * 255,
                    standardLinearExact(x, c, w, 0, 255), 1e-9)
            << c << " " << w << " " << x;
}

TEST(Voi, SigmoidEqualsTheStandardAndDoesNotOverflow) {
  for (double c : {-600.0, 0.0, 40.0})
    for (double w : {1.0, 80.0, 4096.0})
      for (double x = -3000; x <= 3000; x += 7.5)
        ASSERT_NEAR(applyVoi(window(c, w, VoiFunction::Sigmoid), x) * 255, standardSigmoid(x, c, w, 0, 255),
                    1e-9);
  EXPECT_EQ(applyVoi(window(0, 1e-3, VoiFunction::Sigmoid), -1e300), 0);
  EXPECT_EQ(applyVoi(window(0, 1e-3, VoiFunction::Sigmoid), 1e300), 1);
}

// C.11.2.1.2.1, its worked examples: c = 2048, w = 4096 maps 0..4095; c = 2048, w = 1 is a threshold at 2048;
// c = 0, w = 100 is 0 at -50 and below, full above 49; c = 0, w = 1 is 0 for x <= -0.5.
TEST(Voi, TheStandardsExamples) {
  EXPECT_EQ(applyVoi(window(2048, 4096), 0), 0);
  EXPECT_EQ(applyVoi(window(2048, 4096), 4095), 1);
  EXPECT_NEAR(applyVoi(window(2048, 4096), 2047.5), 0.5, 1e-12);
  EXPECT_EQ(applyVoi(window(2048, 1), 2047), 0);
  EXPECT_EQ(applyVoi(window(2048, 1), 2048), 1);
  EXPECT_EQ(applyVoi(window(0, 100), -50), 0);
  EXPECT_EQ(applyVoi(window(0, 100), 49), 1);
  EXPECT_EQ(applyVoi(window(0, 100), 49.5), 1);
  EXPECT_NEAR(applyVoi(window(0, 100), -0.5), 0.5, 1e-12);
  EXPECT_EQ(applyVoi(window(0, 1), -0.5), 0);
  EXPECT_EQ(applyVoi(window(0, 1), std::nextafter(-0.5, 0)), 1);
}

TEST(Voi, RampIsTheSameFunction) {
  for (VoiFunction f : {VoiFunction::Linear, VoiFunction::LinearExact})
    for (double w : {1.0, 2.0, 350.0}) {
      const VoiRamp r = rampOf(window(40, w, f));
      for (double x = -400; x <= 400; x += 0.25) {
        const double y = x <= r.lo ? 0 : x > r.hi ? 1 : (x - r.lo) / (r.hi - r.lo);
        ASSERT_NEAR(y, applyVoi(window(40, w, f), x), 1e-12);
      }
    }
  EXPECT_EQ(rampOf(window(7, 1)).lo, rampOf(window(7, 1)).hi);
}

TEST(Voi, UsableAndNormalised) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(usableWindow(window(0, 1e-9)));
  for (double w : {0.0, -5.0, nan, inf}) EXPECT_FALSE(usableWindow(window(0, w)));
  EXPECT_FALSE(usableWindow(window(nan, 5)));
  EXPECT_FALSE(usableWindow(window(inf, 5)));
  EXPECT_EQ(normalised(window(3, 0.5)).function, VoiFunction::LinearExact);
  EXPECT_EQ(normalised(window(3, 1)).function, VoiFunction::Linear);
  EXPECT_EQ(normalised(window(3, 0.5, VoiFunction::Sigmoid)).function, VoiFunction::Sigmoid);
}

TEST(Voi, NaNStaysNaN) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (VoiFunction f : {VoiFunction::Linear, VoiFunction::LinearExact, VoiFunction::Sigmoid})
    EXPECT_TRUE(std::isnan(applyVoi(window(0, 10, f), nan)));
}

}  // namespace
}  // namespace vernier
