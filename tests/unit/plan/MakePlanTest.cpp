// SPDX-License-Identifier: GPL-3.0-or-later
// The planner with fake techniques: what it takes, what it leaves, and what it says about it. The dumps under
// tests/plan are goldens; to accept a changed one, copy the text that the failing test wrote.
#include "Golden.h"
#include "vernier/plan/MakePlan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "vernier/plan/Presets.h"

namespace vernier {
namespace {

using test::expectGolden;
using ::testing::HasSubstr;

struct FakeParams final : PassParams {
  std::string dump() const override { return "fake"; }
};

struct Fake {
  std::string name;
  Engine engine = Engine::Native;
  double ms = 1, error = 0.01;
  bool fixedFunction = false;
  std::string refuses{};
  std::vector<std::string> kinds{"slice"};
  int passes = 1;
};

Technique technique(const Fake& f) {
  Technique t;
  t.name = f.name;
  t.kinds = f.kinds;
  t.engine = f.engine;
  t.passesFor = [f](const Layer& layer, std::size_t index, const PlanContext&) -> Result<std::vector<Pass>> {
    if (!f.refuses.empty()) return makeError(ErrorCode::NotBuiltYet, f.refuses);
    std::vector<Pass> passes;
    for (int k = 0; k < f.passes; ++k) {
      Pass p;
      p.name = kindOf(layer) + " " + std::to_string(index);
      p.inputs = {"volume v"};
      p.outputs = {"colour", "values"};
      p.predicted_ms = f.ms;
      p.predictedError = f.error;
      p.fixedFunctionFiltering = f.fixedFunction;
      if (f.engine == Engine::Gl) p.resources = {{"texture3d", 1024}};
      p.params = std::make_shared<FakeParams>();
      passes.push_back(std::move(p));
    }
    return passes;
  };
  t.execute = [](const Pass&, Images&, std::stop_token) -> Result<void> { return {}; };
  return t;
}

TechniqueRegistry registryOf(const std::vector<Fake>& fakes) {
  TechniqueRegistry r;
  for (const Fake& f : fakes) EXPECT_TRUE(r.add(technique(f)).ok());
  return r;
}

const Fake kNative{"mpr.native", Engine::Native, 0.4, 0.001};
const Fake kStrips{"mpr.strips", Engine::Gl, 5, 0.3};
const Fake kPolygon{"mpr.polygon", Engine::Gl, 2.5, 1.4, true};

Capabilities software() {
  Capabilities c;
  c.gl = true;
  c.glRenderer = "llvmpipe";
  return c;
}
Capabilities card() {
  Capabilities c = software();
  c.glIsSoftware = false;
  return c;
}
Capabilities noGl() {
  Capabilities c;
  c.glWhyNot = "libOSMesa.so.8 is not installed";
  return c;
}
Scene oneSlice() {
  Scene s;
  s.layers.emplace_back(SliceLayer{"v", {}, {}, Interpolation::Linear, {}, false});
  return s;
}
Result<Plan> planned(const Scene& scene, const Quality& quality, const Capabilities& c,
                     const TechniqueRegistry& r) {
  return makePlan(scene, {512, 512, false}, quality, c, {}, {}, r);
}
std::string chosen(const Quality& q, const Capabilities& c, const std::vector<Fake>& fakes) {
  const auto plan = planned(oneSlice(), q, c, registryOf(fakes));
  return plan ? plan->passes.at(0).technique : std::string(errorName(plan.error().code));
}
std::string whyRejected(const Plan& plan, const std::string& what) {
  for (const Rejected& r : plan.rejected)
    if (r.what == what) return r.why;
  return "not rejected";
}
Quality quality(QualityLevel level, EngineChoice engine = EngineChoice::Auto, const std::string& name = "") {
  Quality q;
  q.level = level;
  q.engine = engine;
  q.technique = name;
  return q;
}

TEST(MakePlan, OnePassForAnAxialSliceAndNativeWinsWithoutACard) {
  const auto plan = planned(oneSlice(), {}, software(), registryOf({kPolygon, kStrips, kNative}));
  ASSERT_TRUE(plan.ok());
  EXPECT_EQ(plan->passes.size(), 1u);
  EXPECT_EQ(plan->passes[0].technique, "mpr.native");
  EXPECT_TRUE(plan->showsWholeScene);
  EXPECT_EQ(plan->rejected.size(), 2u);
  expectGolden("slice-software", dumpPlan(*plan));
}

TEST(MakePlan, WithoutACardNativeWinsEvenWhenSlower) {
  Fake slow = kNative;
  slow.ms = 50;
  EXPECT_EQ(chosen({}, software(), {kStrips, slow}), "mpr.native");
  const auto plan = planned(oneSlice(), {}, software(), registryOf({kStrips, slow}));
  EXPECT_THAT(whyRejected(*plan, "mpr.strips"), HasSubstr("without a card"));
}

TEST(MakePlan, WithACardTheCheapestWins) {
  Fake slow = kNative;
  slow.ms = 50;
  EXPECT_EQ(chosen({}, card(), {slow, kStrips, kPolygon}), "mpr.polygon");
  EXPECT_EQ(chosen({}, card(), {kNative, kStrips, kPolygon}), "mpr.native");
}

TEST(MakePlan, ErrorThatDoesNotFitIsLeft) {
  Fake coarse = kPolygon;
  coarse.error = 3;
  EXPECT_EQ(chosen(quality(QualityLevel::Draft), card(), {coarse, kStrips}), "mpr.polygon");
  EXPECT_EQ(chosen(quality(QualityLevel::Review), card(), {coarse, kStrips}), "mpr.strips");
  const auto plan = planned(oneSlice(), {}, card(), registryOf({coarse, kStrips}));
  EXPECT_EQ(whyRejected(*plan, "mpr.polygon"), "predicted error 3 levels, 2 asked for");
}

TEST(MakePlan, UsersErrorReplacesTheLevels) {
  Quality q;
  q.maxError = 0.1;
  EXPECT_EQ(chosen(q, card(), {kStrips, kPolygon, Fake{"exact", Engine::Gl, 90, 0.05}}), "exact");
  q.maxError = 5;
  EXPECT_EQ(chosen(q, card(), {kStrips, kPolygon}), "mpr.polygon");
  EXPECT_EQ(errorGoal(quality(QualityLevel::Reference)), 0.5);
  EXPECT_EQ(errorGoal(quality(QualityLevel::Draft)), std::numeric_limits<double>::infinity());
}

TEST(MakePlan, WhenNothingFitsTheMostExactIsTakenAndSaid) {
  Quality q;
  q.maxError = 0.0001;
  const auto plan = planned(oneSlice(), q, card(), registryOf({kPolygon, kNative, kStrips}));
  ASSERT_TRUE(plan.ok());
  EXPECT_EQ(plan->passes[0].technique, "mpr.native");
  ASSERT_EQ(plan->notes.size(), 1u);
  EXPECT_THAT(plan->notes[0], HasSubstr("0.0001"));
}

TEST(MakePlan, ReferenceNeverTakesFixedFunctionFiltering) {
  Fake fine = kPolygon;
  fine.error = 0.01;
  const auto q = quality(QualityLevel::Reference);
  EXPECT_EQ(chosen(q, card(), {fine, kStrips}), "mpr.strips");
  const auto plan = planned(oneSlice(), q, card(), registryOf({fine, kStrips}));
  EXPECT_THAT(whyRejected(*plan, "mpr.polygon"), HasSubstr("reference never takes"));
  const auto only = planned(oneSlice(), quality(QualityLevel::Reference, EngineChoice::Gl, "mpr.polygon"),
                            card(), registryOf({fine, kStrips}));
  ASSERT_FALSE(only.ok());
  EXPECT_EQ(only.error().code, ErrorCode::NoTechnique);
}

TEST(MakePlan, EngineAndTechniqueAskedFor) {
  EXPECT_EQ(chosen(quality(QualityLevel::Review, EngineChoice::Gl), software(), {kNative, kStrips, kPolygon}),
            "mpr.polygon");
  EXPECT_EQ(chosen(quality(QualityLevel::Review, EngineChoice::Auto, "mpr.strips"), software(),
                   {kNative, kStrips, kPolygon}),
            "mpr.strips");
  const auto plan = planned(oneSlice(), quality(QualityLevel::Review, EngineChoice::Gl), software(),
                            registryOf({kNative, kStrips, kPolygon}));
  EXPECT_THAT(whyRejected(*plan, "mpr.native"), HasSubstr("gl was asked for"));
  expectGolden("slice-gl-asked", dumpPlan(*plan));
}

TEST(MakePlan, WhatWasAskedForAndCannotIsAnErrorWithItsReason) {
  const auto r = registryOf({kNative, kStrips});
  auto plan = planned(oneSlice(), quality(QualityLevel::Review, EngineChoice::Gl), noGl(), r);
  ASSERT_FALSE(plan.ok());
  EXPECT_EQ(plan.error().code, ErrorCode::NoTechnique);
  EXPECT_THAT(plan.error().sentence, HasSubstr("libOSMesa.so.8 is not installed"));
  EXPECT_EQ(plan.error().where, "/layers/0");
  plan =
      planned(oneSlice(), quality(QualityLevel::Review, EngineChoice::Native, "mpr.strips"), software(), r);
  ASSERT_FALSE(plan.ok());
  EXPECT_THAT(plan.error().sentence, HasSubstr("native was asked for"));
  plan = planned(oneSlice(), quality(QualityLevel::Review, EngineChoice::Auto, "mpr.magic"), software(), r);
  ASSERT_FALSE(plan.ok());
  EXPECT_THAT(plan.error().sentence, HasSubstr("mpr.native, mpr.strips"));
}

TEST(MakePlan, ATechniquesRefusalStandsInThePlan) {
  Fake refusing = kStrips;
  refusing.refuses = "Strips cannot follow a gantry tilt.";
  const auto plan = planned(oneSlice(), {}, card(), registryOf({refusing, kNative}));
  ASSERT_TRUE(plan.ok());
  EXPECT_EQ(whyRejected(*plan, "mpr.strips"), refusing.refuses);
  const auto none = planned(oneSlice(), {}, card(), registryOf({refusing}));
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, ErrorCode::NoTechnique);
  EXPECT_THAT(none.error().sentence, HasSubstr("gantry tilt"));
}

TEST(MakePlan, FaultsOfTheSceneComeThrough) {
  Technique t = technique(kNative);
  t.passesFor = [](const Layer&, std::size_t, const PlanContext&) -> Result<std::vector<Pass>> {
    return makeError(ErrorCode::PlaneDegenerate, "The plane's normal has no length.");
  };
  TechniqueRegistry r;
  ASSERT_TRUE(r.add(t).ok());
  EXPECT_EQ(planned(oneSlice(), {}, software(), r).error().code, ErrorCode::PlaneDegenerate);
}

TEST(MakePlan, AThrowingPlannerIsOnlyRejected) {
  Technique t = technique(kStrips);
  t.passesFor = [](const Layer&, std::size_t, const PlanContext&) -> Result<std::vector<Pass>> {
    throw std::runtime_error("boom");
  };
  TechniqueRegistry r;
  ASSERT_TRUE(r.add(t).ok());
  ASSERT_TRUE(r.add(technique(kNative)).ok());
  const auto plan = planned(oneSlice(), {}, card(), r);
  ASSERT_TRUE(plan.ok());
  EXPECT_THAT(whyRejected(*plan, "mpr.strips"), HasSubstr("boom"));
}

TEST(MakePlan, ALayerOfAnAbsentPluginIsKeptAndSaid) {
  Scene scene = oneSlice();
  scene.layers.emplace_back(CustomLayer{"shells", 1, R"({"kind":"shells"})"});
  scene.layers.emplace_back(CustomLayer{"acme.flow", 2, R"({"kind":"acme.flow"})"});
  const auto plan = planned(scene, {}, software(), registryOf({kNative}));
  ASSERT_TRUE(plan.ok());
  EXPECT_EQ(plan->passes.size(), 1u);
  EXPECT_FALSE(plan->showsWholeScene);
  ASSERT_EQ(plan->notes.size(), 2u);
  EXPECT_EQ(plan->notes[0], "layer 1 (shells) needs plugin angiography: not shown");
  expectGolden("absent-plugins", dumpPlan(*plan));
}

TEST(MakePlan, NoPluginAtAll) {
  const auto plan = planned(oneSlice(), {}, software(), {});
  ASSERT_TRUE(plan.ok());
  EXPECT_TRUE(plan->passes.empty());
  ASSERT_EQ(plan->notes.size(), 1u);
  EXPECT_EQ(plan->notes[0], "layer 0 (slice) needs plugin mpr: not shown");
}

TEST(MakePlan, CustomLayersHaveTechniquesToo) {
  Scene scene;
  scene.layers.emplace_back(CustomLayer{"acme.flow", 2, R"({"kind":"acme.flow"})"});
  Fake flow{"acme.flow.native"};
  flow.kinds = {"acme.flow"};
  flow.passes = 3;
  const auto plan = planned(scene, {}, software(), registryOf({kNative, flow}));
  ASSERT_TRUE(plan.ok());
  EXPECT_EQ(plan->passes.size(), 3u);
  EXPECT_TRUE(plan->rejected.empty()) << "a technique of another kind is no candidate";
}

TEST(MakePlan, ANamedTechniqueRulesTheLayersThatItDraws) {
  Scene scene = oneSlice();
  scene.layers.emplace_back(CustomLayer{"acme.flow", 2, R"({"kind":"acme.flow"})"});
  Fake flow{"acme.flow.native"};
  flow.kinds = {"acme.flow"};
  Quality quality;
  quality.technique = "mpr.native";
  const auto plan = planned(scene, quality, software(), registryOf({kNative, kStrips, flow}));
  ASSERT_TRUE(plan.ok()) << plan.error().text();
  ASSERT_EQ(plan->passes.size(), 2u);
  EXPECT_EQ(plan->passes[0].technique, "mpr.native");
  EXPECT_EQ(plan->passes[1].technique, "acme.flow.native");
}

TEST(MakePlan, ANamedTechniqueThatDrawsNothingHereIsRefused) {
  Fake flow{"acme.flow.native"};
  flow.kinds = {"acme.flow"};
  Quality quality;
  quality.technique = "acme.flow.native";
  const auto plan = planned(oneSlice(), quality, software(), registryOf({kNative, flow}));
  ASSERT_FALSE(plan.ok());
  EXPECT_EQ(plan.error().code, ErrorCode::NoTechnique);
  EXPECT_THAT(plan.error().sentence, HasSubstr("draws no layer of this scene"));
}

TEST(MakePlan, TwoWholePicturesAreRefused) {
  Scene scene = oneSlice();
  scene.layers.push_back(oneSlice().layers[0]);
  const auto plan = planned(scene, {}, software(), registryOf({kNative}));
  ASSERT_FALSE(plan.ok());
  EXPECT_EQ(plan.error().code, ErrorCode::NotBuiltYet);

  // A picture that nobody here draws stands in nobody's way: it is kept, and said.
  Scene absent = stackScene("v", 0, {});
  absent.layers.push_back(oneSlice().layers[0]);
  const auto kept = planned(absent, {}, software(), registryOf({kNative}));
  ASSERT_TRUE(kept.ok());
  EXPECT_FALSE(kept->showsWholeScene);
  EXPECT_EQ(kept->passes.size(), 1u);
}

TEST(MakePlan, EmptyScenesAndPictures) {
  EXPECT_EQ(planned({}, {}, software(), registryOf({kNative})).error().code, ErrorCode::SceneInvalid);
  EXPECT_EQ(makePlan(oneSlice(), {0, 5, false}, {}, software(), {}, {}, registryOf({kNative})).error().code,
            ErrorCode::SceneInvalid);
  Scene scene = oneSlice();
  scene.camera.zoom = 0;
  EXPECT_EQ(planned(scene, {}, software(), registryOf({kNative})).error().where, "/camera/zoom");
}

TEST(MakePlan, FrameRateThatIsOutOfReachIsSaid) {
  Quality q;
  q.minFps = 500;
  const auto plan = planned(oneSlice(), q, card(), registryOf({kStrips}));
  ASSERT_EQ(plan->notes.size(), 1u);
  EXPECT_EQ(plan->notes[0], "predicted 200 frames per second, 500 asked for");
  q.minFps = 100;
  EXPECT_TRUE(planned(oneSlice(), q, card(), registryOf({kStrips}))->notes.empty());
}

TEST(MakePlan, AFrameRateRejectsWhatIsTooSlow) {
  const Fake exact{"mpr.exact", Engine::Native, 40, 0.01}, quick{"mpr.quick", Engine::Native, 4, 3.0};
  Quality q;
  EXPECT_EQ(chosen(q, noGl(), {exact, quick}), "mpr.exact") << "the goal of review";
  q.minFps = 50;
  EXPECT_EQ(chosen(q, noGl(), {exact, quick}), "mpr.quick");
  const auto plan = planned(oneSlice(), q, noGl(), registryOf({exact, quick}));
  EXPECT_THAT(whyRejected(*plan, "mpr.exact"), HasSubstr("40 ms, too slow for the 50 frames per second"));
  ASSERT_EQ(plan->notes.size(), 1u);
  EXPECT_THAT(plan->notes[0], HasSubstr("predicted error 3 levels, 2 wanted"));
  q.minFps = 500;
  EXPECT_EQ(chosen(q, noGl(), {exact, quick}), "mpr.quick")
      << "neither is fast enough: the one that comes closer";
  q.minFps = 20;
  EXPECT_EQ(chosen(q, noGl(), {exact, quick}), "mpr.exact") << "fast enough";
  q.minFps = 50;
  q.maxError = 1;
  EXPECT_EQ(chosen(q, noGl(), {exact, quick}), "mpr.exact") << "an error that was asked for goes before";
  q.maxError.reset();
  q.level = QualityLevel::Reference;
  EXPECT_EQ(chosen(q, noGl(), {exact, quick}), "mpr.exact");
  q.level = QualityLevel::Review;
  EXPECT_EQ(chosen(q, card(), {{"mpr.native", Engine::Native, 40, 0.01}, kStrips}), "mpr.strips");
  EXPECT_EQ(chosen(q, software(), {{"mpr.native", Engine::Native, 40, 0.01}, kStrips}), "mpr.strips")
      << "native goes first only where it is fast enough";
}

TEST(MakePlan, PureAndTiesGoToTheFirst) {
  Fake twin = kNative;
  twin.name = "mpr.twin";
  const auto r = registryOf({kNative, twin, kPolygon});
  const std::string first = dumpPlan(*planned(oneSlice(), {}, software(), r));
  for (int k = 0; k < 5; ++k) EXPECT_EQ(dumpPlan(*planned(oneSlice(), {}, software(), r)), first);
  EXPECT_EQ(chosen({}, software(), {kNative, twin}), "mpr.native");
  EXPECT_EQ(chosen({}, software(), {twin, kNative}), "mpr.twin");
  twin.error = kNative.error / 2;
  EXPECT_EQ(chosen({}, software(), {kNative, twin}), "mpr.twin") << "same cost: the more exact one";
}

TEST(MakePlan, PluginsOfKinds) {
  EXPECT_EQ(pluginOf("slice"), "mpr");
  EXPECT_EQ(pluginOf("shells"), "angiography");
  EXPECT_EQ(pluginOf("volume"), "dvr");
  EXPECT_EQ(pluginOf("acme.flow"), "acme");
  EXPECT_EQ(pluginOf("acme"), "");
}

}  // namespace
}  // namespace vernier
