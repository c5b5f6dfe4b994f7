// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/TransferFunction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "Grids.h"

namespace vernier {
namespace {

TransferFunction simple() {
  return {{{0, {1, 0, 0}}, {10, {0, 1, 0}}}, {{0, 0}, {10, 0.5}, {20, 0.5}, {20, 1}, {30, 0.25}}, 2.0};
}

std::string faultOf(const TransferFunction& f) {
  const Result<void> r = checkTransferFunction(f);
  return r ? "" : r.error().where;
}

TEST(TransferFunction, IsLinearBetweenPointsAndHeldBeyond) {
  const TransferFunction f = simple();
  EXPECT_EQ(colourAt(f, -5), glm::dvec3(1, 0, 0));
  EXPECT_EQ(colourAt(f, 50), glm::dvec3(0, 1, 0));
  EXPECT_NEAR(colourAt(f, 2.5).y, 0.25, 1e-15);
  EXPECT_NEAR(colourAt(f, 2.5).x, 0.75, 1e-15);
  EXPECT_EQ(opacityAt(f, -1), 0);
  EXPECT_NEAR(opacityAt(f, 4), 0.2, 1e-15);
  EXPECT_NEAR(opacityAt(f, 25), 0.625, 1e-15);
  EXPECT_EQ(opacityAt(f, 1e30), 0.25);
}

TEST(TransferFunction, AStepHoldsFromItsValueOn) {
  const TransferFunction f = simple();
  EXPECT_NEAR(opacityAt(f, std::nextafter(20, 0)), 0.5, 1e-12);
  EXPECT_EQ(opacityAt(f, 20), 1);
}

TEST(TransferFunction, NoDataShowsNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(opacityAt(simple(), nan), 0);
  EXPECT_EQ(colourAt(simple(), nan), glm::dvec3(0));
}

TEST(TransferFunction, ExtinctionIsThatOfItsLength) {
  // exp(-tau L) over the length that the opacity is of leaves 1 - a.
  const TransferFunction f = simple();
  EXPECT_NEAR(std::exp(-extinctionAt_perMm(f, 4) * 2), 0.8, 1e-15);
  EXPECT_EQ(extinctionAt_perMm(f, 20), std::numeric_limits<double>::infinity());
  EXPECT_EQ(extinctionAt_perMm(f, -3), 0);
}

TEST(TransferFunction, OpacityOverALengthIsExactAtBothEnds) {
  EXPECT_NEAR(opacityOver(0.5, 2), 0.75, 1e-15);
  EXPECT_NEAR(opacityOver(0.5, 0.5), 1 - std::sqrt(0.5), 1e-15);
  EXPECT_EQ(opacityOver(1, 0.01), 1);
  EXPECT_EQ(opacityOver(1, 0), 0);
  EXPECT_EQ(opacityOver(0, 1000), 0);
  EXPECT_NEAR(opacityOver(1e-12, 3) / 3e-12, 1, 1e-9);  // no cancellation
  EXPECT_TRUE(std::isfinite(opacityOver(1 - 1e-7, 8)));
  EXPECT_EQ(opacityOverLinear(0.5, 3), 1);
  EXPECT_NEAR(opacityOverLinear(0.25, 0.5), 0.125, 1e-15);
}

TEST(TransferFunction, GreatestOpacityLooksBetweenTheEnds) {
  const TransferFunction f = simple();
  EXPECT_EQ(greatestOpacity(f, -100, 0), 0);
  EXPECT_EQ(greatestOpacity(f, 15, 25), 1);  // the step inside
  EXPECT_EQ(greatestOpacity(f, 20, 20), 1);
  EXPECT_NEAR(greatestOpacity(f, 2, 4), 0.2, 1e-15);
  EXPECT_EQ(greatestOpacity(f, 5, 4), 0);
}

TEST(TransferFunction, KnotsAreAscendingAndSingle) {
  EXPECT_EQ(knotsOf(simple()), (std::vector<double>{0, 10, 20, 30}));
}

TEST(TransferFunction, RefusesWhatHasNoMeaningWithItsPlace) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  TransferFunction f = simple();
  EXPECT_EQ(faultOf(f), "");
  f.opacities[2].value = nan;
  EXPECT_EQ(faultOf(f), "/opacities/2");
  f = simple(), f.opacities[1].opacity = nan;
  EXPECT_EQ(faultOf(f), "/opacities/1");
  f = simple(), f.opacities[1].value = 25;  // unsorted
  EXPECT_EQ(faultOf(f), "/opacities/2");
  f = simple(), f.opacities[1].value = 20;  // three points of one value
  EXPECT_EQ(faultOf(f), "/opacities/3");
  f = simple(), f.colours.clear();
  EXPECT_EQ(faultOf(f), "/colours");
  f = simple(), f.colours[0].colour.y = 1.5;
  EXPECT_EQ(faultOf(f), "/colours/0");
  f = simple(), f.opacityLength_mm = 0;
  EXPECT_EQ(faultOf(f), "/opacity_length_mm");
  f = simple();
  f.opacities.assign(kMostTransferPoints + 1, {0, 0});
  EXPECT_EQ(faultOf(f), "/opacities");
}

TEST(TransferFunction, TakesTenThousandPoints) {
  TransferFunction f{{{0, glm::dvec3(1)}}, {}, 1};
  for (int n = 0; n < 10000; ++n) f.opacities.push_back({0.1 * n, 0.5 + 0.5 * std::sin(0.01 * n)});
  ASSERT_TRUE(checkTransferFunction(f));
  EXPECT_NEAR(opacityAt(f, 500.0), 0.5 + 0.5 * std::sin(50.0), 1e-12);
}

std::shared_ptr<const Volume> ofRange(float least, float greatest) {
  VolumeInfo info;
  info.grid = test::unitGrid(2, 2, 2);
  return test::volumeOf<float>(info, {least, greatest, least, least, greatest, least, least, least});
}

TEST(TransferPresets, AllAreValidOnAnyVolume) {
  for (const auto& volume : {ofRange(-1000, 2000), ofRange(0, 255), ofRange(7, 7)})
    for (const std::string& name : transferPresets()) {
      const Result<TransferFunction> f = transferPreset(name, *volume);
      ASSERT_TRUE(f) << name;
      EXPECT_TRUE(checkTransferFunction(*f)) << name;
    }
  EXPECT_FALSE(transferPreset("nonsense", *ofRange(0, 1)));
}

TEST(TransferPresets, RampIsOfTheRange) {
  const Result<TransferFunction> f = transferPreset("ramp", *ofRange(100, 300));
  ASSERT_TRUE(f);
  EXPECT_NEAR(opacityAt(*f, 150), 0, 1e-15);  // a quarter
  EXPECT_NEAR(opacityAt(*f, 200), 0.15, 1e-15);
  EXPECT_NEAR(opacityAt(*f, 300), 0.8, 1e-15);
  EXPECT_EQ(f->opacityLength_mm, 1);
}

TEST(TransferPresets, CtIsTakenForCtOnly) {
  EXPECT_EQ(defaultTransferPreset(*ofRange(-1024, 1500)), "ct");
  EXPECT_EQ(defaultTransferPreset(*ofRange(-400, 1500)), "ramp");
  EXPECT_EQ(defaultIsoLevel(*ofRange(-1024, 1500)), 300);
  EXPECT_EQ(defaultIsoLevel(*ofRange(0, 500)), 250);
}

}  // namespace
}  // namespace vernier
