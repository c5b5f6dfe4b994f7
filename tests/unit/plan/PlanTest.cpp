// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "vernier/plan/Scene.h"

namespace vernier {
namespace {

using ::testing::HasSubstr;

TEST(DumpPlan, NumbersAreRounded) {
  Plan plan;
  Pass p;
  p.name = "slice 0";
  p.technique = "t";
  p.predicted_ms = 0.1 + 0.2;
  p.predictedError = 1.0 / 3;
  plan.passes.push_back(p);
  EXPECT_THAT(dumpPlan(plan), HasSubstr("predicted: 0.3 ms, error 0.33 of 255"));
}

TEST(Scene, KindOf) {
  EXPECT_EQ(kindOf(ImageLayer{}), "image");
  EXPECT_EQ(kindOf(SliceLayer{}), "slice");
  EXPECT_EQ(kindOf(CustomLayer{"acme", 1, "{}"}), "acme");
}

}  // namespace
}  // namespace vernier
