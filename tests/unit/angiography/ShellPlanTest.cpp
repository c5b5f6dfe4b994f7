// SPDX-License-Identifier: GPL-3.0-or-later
// Plans of shells: what they say, what they refuse.
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "ShellCases.h"
#include "TestPaths.h"

namespace vernier::test {
namespace {

using ::testing::HasSubstr;

TEST(ShellPlan, LevelsOutsideTheDataAreSaid) {
  ShellCase c;
  c.shells().levels = {-5, 60, 5000, 6000};
  const Result<Plan> plan = c.plan();
  ASSERT_TRUE(plan.ok());
  EXPECT_THAT(plan->notes, ::testing::Contains(::testing::HasSubstr("2 of 4 levels lie above all values")));
  EXPECT_THAT(plan->notes, ::testing::Contains(::testing::HasSubstr("1 of 4 levels lie below all values")));
  c.shells().levels = {60, 90};
  EXPECT_THAT(c.plan()->notes, ::testing::Not(::testing::Contains(::testing::HasSubstr("levels lie"))));
}

TEST(ShellPlan, OnePassThatSaysWhatItShows) {
  ShellCase c;
  c.shells().disabled = {4};
  const Result<Plan> plan = c.plan("shells.native");
  ASSERT_TRUE(plan.ok()) << plan.error().text();
  ASSERT_EQ(plan->passes.size(), 1u);
  EXPECT_EQ(plan->passes[0].params->dump().substr(0, 67),
            "max, 4 of 5 levels from 30 to 120, beta0 0, beta_m 1, a 0, b 1; ort");
  EXPECT_THAT(plan->notes, ::testing::Contains(HasSubstr("no bound of the true values")));
  EXPECT_THAT(plan->notes, ::testing::Contains("1 of 5 levels are disabled"));
  EXPECT_GT(plan->passes[0].resources[0].bytes, 10000u);
}

TEST(ShellPlan, PlanGolden) {
  ShellCase c;
  c.scene.camera.projection = Projection::Perspective;
  c.scene.crop = CropBox{VoxelPoint(4, 3, 2), VoxelPoint(16, 15, 9)};
  c.shells().a = 0.5, c.shells().b = 0.2, c.shells().disabled = {0};
  Capabilities machine;
  machine.gl = true, machine.threads = 2;
  const std::string path = std::string(VERNIER_SOURCE_DIR) + "/tests/plan/shells.plan.txt";
  std::ifstream in(path);
  std::stringstream golden;
  golden << in.rdbuf();
  EXPECT_EQ(dumpPlan(*makePlan(c.scene, c.view, Quality{}, machine, CostTable{}, c.sources,
                               ShellHost::instance().registry)),
            golden.str())
      << "golden: " << path;
}

TEST(ShellPlan, WhatCannotBeDrawnIsSaidWithItsPlace) {
  const auto errorOf = [](const std::function<void(ShellCase&)>& change) {
    ShellCase c;
    change(c);
    const Result<Plan> plan = c.plan("shells.native");
    EXPECT_FALSE(plan.ok());
    return plan.error();
  };
  EXPECT_EQ(errorOf([](ShellCase& c) { c.shells().source = "w"; }).where, "/layers/0/source");
  EXPECT_EQ(errorOf([](ShellCase& c) { c.shells().a = -1; }).where, "/layers/0/a");
  EXPECT_EQ(errorOf([](ShellCase& c) { c.shells().betaM = 0; }).where, "/layers/0/beta_m");
  EXPECT_EQ(errorOf([](ShellCase& c) { c.shells().beta0 = NAN; }).where, "/layers/0/beta0");
  EXPECT_EQ(errorOf([](ShellCase& c) { c.shells().levels = {5, 4}; }).where, "/layers/0/levels");
}

TEST(ShellPlan, D5_OneLevelAndTooMany) {
  ShellCase c;
  c.shells().levels.clear();
  c.shells().count = 1;
  EXPECT_EQ(c.job().shells.size(), 1u);
  c.shells().count = 1024;
  EXPECT_TRUE(c.draw().ok());
  c.shells().count = 4096;
  EXPECT_THAT(c.plan("shells.native").error().sentence, HasSubstr("there may be 1 to 1024"));
}

TEST(ShellPlan, D5_OverTheMemoryBudgetIsRefusedWithTheBytesNeeded) {
  ShellCase c;
  class SmallHost final : public Host {
    Result<void> addTechnique(Technique) override { return {}; }
    Result<gpu::Device*> glDevice() override { return makeError(ErrorCode::GlUnavailable, "none"); }
    DerivedCache& derivedData() override { return cache_; }
    DerivedCache cache_{100'000};
  } host;
  angiography::ShellStore small(host);
  const PlanContext context{c.scene,     c.view,   Quality{}, ShellHost::instance().capabilities,
                            CostTable{}, c.sources};
  const auto refused = angiography::shellParams(c.scene.layers[0], 0, context, small);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::OutOfMemory);
  EXPECT_THAT(refused.error().sentence, HasSubstr("5 levels need about 1 MB and 1 MB may be used"));
}

TEST(ShellPlan, LevelsByHistogramAreFoundOncePerVolume) {
  ShellCase c;
  c.shells().levels.clear();
  c.shells().count = 4, c.shells().spread = LevelSpread::Histogram;
  const auto job = c.job();
  ASSERT_EQ(job.shells.size(), 4u);
  const std::uint64_t bytes = ShellHost::instance().store->cache().bytes();
  EXPECT_EQ(c.job().shells[2].level, job.shells[2].level);
  EXPECT_EQ(ShellHost::instance().store->cache().bytes(), bytes);
}

}  // namespace
}  // namespace vernier::test
