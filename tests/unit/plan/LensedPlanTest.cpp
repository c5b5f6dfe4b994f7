// SPDX-License-Identifier: GPL-3.0-or-later
// How the planner puts a picture with a lens together, with fake techniques.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "PairsOfTheAlgebra.h"

namespace vernier {
namespace {

struct Fake {
  std::string name, kind;
  double ms = 1, error = 0.01;
  bool fixedFunction = false;
  bool together = false;
};

Technique technique(const Fake& f) {
  Technique t;
  t.name = f.name, t.kinds = {f.kind}, t.drawsParts = f.kind != "lens";
  if (f.together)
    t.together = [](std::span<const Pass* const> passes) -> std::optional<Pass> {
      EXPECT_EQ(passes.size(), 2u);
      Pass p = *passes[0];
      p.name = passes[1] ? "both" : "one";
      return p;
    };
  t.passesFor = [f](const Layer&, std::size_t, const PlanContext& context) -> Result<std::vector<Pass>> {
    Pass p;
    p.predicted_ms = f.ms, p.predictedError = f.error, p.fixedFunctionFiltering = f.fixedFunction;
    return std::vector<Pass>(f.kind == "lens" && !context.together ? 2 : 1, p);
  };
  t.region = [](const LensLayer&, const Sources&) -> Result<std::shared_ptr<const ConvexRegion>> {
    return test::boxRegion({0.5, 1, -10}, {10.5, 5, 10});
  };
  t.execute = [](const Pass&, Images&, std::stop_token) -> Result<void> { return {}; };
  return t;
}

Result<Plan> planned(QualityLevel level, const std::vector<Fake>& fakes,
                     test::algebra::Kind inside = test::algebra::Kind::Blend) {
  using namespace test::algebra;
  const Case c = makeCase(Kind::Blend, inside, With::Nothing, fourVoxels());
  TechniqueRegistry r;
  for (const Fake& f : fakes) EXPECT_TRUE(r.add(technique(f)).ok());
  Quality q;
  q.level = level;
  return makePlan(c.scene, c.view, q, {}, {}, c.sources, r);
}

const Fake kLens{"lens.native", "lens"};

TEST(LensedPlan, CutFirstOutsideInsideOutsideBehindJoin) {
  const auto plan = planned(QualityLevel::Review, {kLens, {"a", "volume"}});
  ASSERT_TRUE(plan.ok()) << plan.error().text();
  ASSERT_EQ(plan->passes.size(), 5u);
  using Which = RaysOfPass::Which;
  const std::string techniques[] = {"lens.native", "a", "a", "a", "lens.native"};
  for (std::size_t n = 0; n < 5; ++n) EXPECT_EQ(plan->passes[n].technique, techniques[n]) << n;
  EXPECT_EQ(plan->passes[1].rays, (RaysOfPass{Which::First, 0}));
  EXPECT_EQ(plan->passes[2].rays, (RaysOfPass{Which::All, 1}));
  EXPECT_EQ(plan->passes[3].rays, (RaysOfPass{Which::Rest, 0}));
}

TEST(LensedPlan, AppearancesOfOneTechniqueThatCanAreDrawnTogether) {
  using test::algebra::Kind;
  const Fake able{"a", "volume", 1, 0.01, false, true}, iso{"b", "isosurface", 1, 0.01, false, true};
  for (const Kind inside : {Kind::Blend, Kind::CutOut}) {
    const auto plan = planned(QualityLevel::Review, {kLens, able}, inside);
    ASSERT_TRUE(plan.ok()) << plan.error().text();
    ASSERT_EQ(plan->passes.size(), 2u);
    EXPECT_EQ(plan->passes[0].technique, "lens.native");
    EXPECT_EQ(plan->passes[1].technique, "a");
    EXPECT_EQ(plan->passes[1].name, inside == Kind::Blend ? "both" : "one");
    EXPECT_EQ(plan->passes[1].rays, (RaysOfPass{RaysOfPass::Which::Together, 0}));
  }
  // Of two techniques, or of one that cannot: in parts.
  const auto two = planned(QualityLevel::Review, {kLens, able, iso}, Kind::Iso);
  ASSERT_TRUE(two.ok()) << two.error().text();
  EXPECT_EQ(two->passes.size(), 5u);
}

TEST(LensedPlan, AnAppearanceIsDrawnByTheCheapestThatFits) {
  const auto plan =
      planned(QualityLevel::Reference,
              {kLens, {"coarse", "volume", 1, 3}, {"slow", "volume", 9, 0.1}, {"quick", "volume", 4, 0.4}});
  ASSERT_TRUE(plan.ok()) << plan.error().text();
  EXPECT_EQ(plan->passes[1].technique, "quick");
}

TEST(LensedPlan, ReferenceNeverTakesFixedFunctionFiltering) {
  const std::vector<Fake> fakes{kLens, {"a", "volume", 1, 0.01, true}};
  EXPECT_TRUE(planned(QualityLevel::Review, fakes).ok());
  const auto plan = planned(QualityLevel::Reference, fakes);
  ASSERT_FALSE(plan.ok());
  EXPECT_THAT(plan.error().sentence, ::testing::HasSubstr("8-bit weights"));
}

}  // namespace
}  // namespace vernier
