// SPDX-License-Identifier: GPL-3.0-or-later
// The shipped combiners against the paper's equations, with numbers worked out by hand; then the machine's
// own rules, one by one.
#include <gtest/gtest.h>

#include "CombinerForTest.h"

namespace vernier::dvr {
namespace {
using test::Filling;
using test::shipped;

void expectNear(const glm::dvec4& got, const glm::dvec4& want, double bound = 1e-12) {
  for (glm::length_t n = 0; n < 4; ++n) EXPECT_NEAR(got[n], want[n], bound) << "channel " << n;
}

TEST(CombinerValues, Figure6InterpolatesBetweenTwoSlices) {
  Filling f;
  f.texture(0) = {0.2, 0.4, 1, 0.8};
  f.texture(1) = {1, 0, 0.5, 0.4};
  f[Register::Constant0] = {0.9, 0.9, 0.9, 0.25};  // only alpha counts
  // Equation 1: 0.75 S_0 + 0.25 S_1
  expectNear(combine(shipped("intermediate-slice"), f.r), {0.4, 0.3, 0.875, 0.7});
  f[Register::Constant0].w = 0;
  expectNear(combine(shipped("intermediate-slice"), f.r), {0.2, 0.4, 1, 0.8});
  f[Register::Constant0].w = 1;
  expectNear(combine(shipped("intermediate-slice-weighted"), f.r), {1, 0, 0.5, 0.4});
}

TEST(CombinerValues, Figure8BlendsTwoSlicesAtOnce) {
  Filling f;
  f.texture(0) = {1, 0.5, 0, 0.6};
  f.texture(1) = {0.2, 0.4, 0.8, 0.25};
  // Equation 4: C0 A0 (1 - A1) + C1 A1 = C0 0.45 + C1 0.25; equation 5: 0.4 0.75
  const glm::dvec4 got = combine(shipped("two-slices"), f.r);
  expectNear(got, {0.5, 0.325, 0.2, 0.3});
  // Equation 3 twice, over a destination: the same picture.
  const glm::dvec3 d(0.3, 0.9, 0.1);
  const auto over = [](const glm::dvec4& s, const glm::dvec3& under) {
    return glm::dvec3(s) * s.w + under * (1 - s.w);
  };
  const glm::dvec3 twice = over(f.texture(1), over(f.texture(0), d)), once = glm::dvec3(got) + d * got.w;
  for (glm::length_t n = 0; n < 3; ++n) EXPECT_NEAR(once[n], twice[n], 1e-12);
}

TEST(CombinerValues, FourSlicesAreFourTimesEquation3) {
  Filling f;
  const glm::dvec4 s[] = {{1, 0.5, 0, 0.6}, {0.2, 0.4, 0.8, 0.25}, {0.1, 1, 0.3, 0.5}, {0.7, 0, 1, 0.1}};
  glm::dvec3 picture(0.3, 0.9, 0.1);
  const glm::dvec3 d = picture;
  for (std::size_t n = 0; n < 4; ++n) {
    f.texture(n) = s[n];
    picture = glm::dvec3(s[n]) * s[n].w + picture * (1 - s[n].w);
  }
  const glm::dvec4 got = combine(shipped("four-slices"), f.r);
  EXPECT_NEAR(got.w, 0.4 * 0.75 * 0.5 * 0.9, 1e-12);
  for (glm::length_t n = 0; n < 3; ++n) EXPECT_NEAR(got[n] + d[n] * got.w, picture[n], 1e-12);
}

Filling lit() {
  Filling f;
  f.texture(0) = {0.6, 0, 0.8, 0.5};
  f.texture(1) = {0, -0.6, 0.8, 0.9};
  f[Register::Constant0] = {0, 0, 0, 0.5};
  f[Register::Constant1] = {0, 0.6, 0.8, 0};
  f[Register::Primary] = {0.5, 0.25, 1, 0};
  f[Register::Secondary] = {0.1, 0.2, 0.05, 0};
  return f;
}

TEST(CombinerValues, Figure9LightsAnInterpolatedNormal) {
  Filling f = lit();
  // n = (0.3, -0.3, 0.8), n.l = -0.18 + 0.64 = 0.46. Equation 6: Ia + Id 0.46.
  expectNear(combine(shipped("iso"), f.r), {0.33, 0.315, 0.51, 0.7});
  // A light from behind leaves the ambient colour.
  f[Register::Constant1] = {0, -0.6, -0.8, 0};
  f.texture(1) = f.texture(0);
  expectNear(combine(shipped("iso"), f.r), {0.1, 0.2, 0.05, 0.5});
  EXPECT_EQ(shipped("iso").test, FragmentTest::Level);
  EXPECT_EQ(shipped("iso").blend, Blending::Off);
}

TEST(CombinerValues, VariantAIsFigure9WithBlending) {
  const Combiner a = shipped("shaded-global"), iso = shipped("iso");
  expectNear(combine(a, lit().r), {0.33, 0.315, 0.51, 0.7});
  EXPECT_EQ(a.stages, iso.stages);
  EXPECT_EQ(a.final, iso.final);
  EXPECT_EQ(a.test, FragmentTest::None);
  EXPECT_EQ(a.blend, Blending::Over);
  EXPECT_TRUE(uses(a, Quantity::NormalOpacity));
  EXPECT_FALSE(uses(a, Quantity::NormalValue));
}

TEST(CombinerValues, SecondLightOfOneColour) {
  Filling f = lit();
  f[Register::Constant0] = {1, 0, 0, 0.5};  // n.l1 = 0.3
  // Ia + Id (0.46 + 0.3)
  expectNear(combine(shipped("iso-two-lights"), f.r), {0.48, 0.39, 0.81, 0.7});
  f[Register::Constant0] = {-1, 0, 0, 0.5};  // behind: takes nothing away from the first
  expectNear(combine(shipped("iso-two-lights"), f.r), {0.33, 0.315, 0.51, 0.7});
  f[Register::Primary] = {1, 1, 1, 0};
  f[Register::Constant0] = f[Register::Constant1] = {0, 0, 1, 0.5};  // 2 x 0.8 + Ia: as white as can be
  expectNear(combine(shipped("iso-two-lights"), f.r), {1, 1, 1, 0.7});
}

TEST(CombinerValues, SecondLightOfItsOwnColour) {
  Filling f = lit();
  f[Register::Constant0] = {1, 0, 0, 0.5};
  f[Register::Secondary] = {0, 1, 0.1, 0};
  f[Register::Primary].w = 0.15;
  // 0.15 + (0.5, 0.25, 1) 0.46 + (0, 1, 0.1) 0.3
  expectNear(combine(shipped("iso-two-colours"), f.r), {0.38, 0.565, 0.64, 0.7});
}

TEST(CombinerValues, Figure10HasTheAmbientColourOfEachVoxel) {
  Filling f;
  f.texture(0) = {0, 0.6, 0.8, 0};
  f.texture(1) = {0.2, 0.1, 0.5, 0.3};
  f[Register::Constant0] = {0, 0, 1, 0};
  f[Register::Primary] = {0.5, 0.25, 1, 0};
  // Ia + Id 0.8; blue is clamped
  expectNear(combine(shipped("shaded-per-voxel"), f.r), {0.6, 0.3, 1, 0.3});
  // own (0.3 + (0.5, 0.25, 1) 0.8)
  f[Register::Secondary] = {0.3, 0.3, 0.3, 0};
  expectNear(combine(shipped("shaded-own-colour"), f.r), {0.2 * 0.7, 0.1 * 0.5, 0.5 * 1.1, 0.3});
}

TEST(CombinerValues, Figure12FollowsTheVerticesAlpha) {
  Filling f;
  f.texture(0) = {0.2, 0.4, 1, 1};
  f.texture(1) = {1, 0, 0.5, 0.5};
  f[Register::Primary] = {1, 1, 1, 0};
  expectNear(combine(shipped("strip"), f.r), {0.2, 0.4, 1, 1});
  f[Register::Primary].w = 1;
  expectNear(combine(shipped("strip"), f.r), {1, 0, 0.5, 0.5});
  f[Register::Primary].w = 0.125;
  expectNear(combine(shipped("strip"), f.r), {0.3, 0.35, 0.9375, 0.9375});
}

// One stage whose RGB portion is `rgb`, its result as the colour; constants are primary (0.5, -0.25, -2, 0.4)
// and secondary (0.2, 0.4, 0.6, 0).
glm::dvec4 of(const std::string& rgb, const std::string& final, const std::string& alpha = "") {
  const std::string json = R"({"schema": 1, "title": "t", "inputs": {"primary": [0.5, -0.25, -1, 0.4],
    "secondary.rgb": [0.2, 0.4, 0.6]}, "stages": [{"rgb": {)" +
                           rgb + "}" + (alpha.empty() ? "" : ", \"alpha\": {" + alpha + "}") +
                           R"(}], "final": {)" + final + "}}";
  const Result<Combiner> c = parseCombiner(json, "t");
  if (!c) {
    ADD_FAILURE() << c.error().text();
    return {};
  }
  return combine(*c, filledRegisters(*c, [](const Input&) { return glm::dvec4(9); }));
}

TEST(CombinerValues, MappingsOfAStage) {
  const std::string show = R"("C": "spare0", "G": "primary")";
  const auto times1 = [&](const std::string& a) {
    return of("\"A\": \"" + a + R"(", "B": "one", "AB": "spare0")", show);
  };
  expectNear(times1("primary"), {0.5, 0, 0, 0.4});
  expectNear(times1("unsigned primary"), {0.5, 0, 0, 0.4});
  expectNear(times1("inverted primary"), {0.5, 1, 1, 0.4});
  expectNear(times1("expand secondary"), {0, 0, 0.2, 0.4});  // -0.6, -0.2, 0.2
  expectNear(times1("signed primary"), {0.5, 0, 0, 0.4});    // the final stage clamps
  expectNear(times1("negate primary"), {0, 0.25, 1, 0.4});
  expectNear(times1("primary.alpha"), {0.4, 0.4, 0.4, 0.4});
  expectNear(times1("expand zero"), {0, 0, 0, 0.4});
}

TEST(CombinerValues, BiasThenScaleThenClamp) {
  const std::string sum =
      R"("A": "primary.alpha", "B": "one", "C": "secondary", "D": "one", "AB+CD": "spare0")";
  const std::string show = R"("C": "spare0", "G": "primary")";
  expectNear(of(sum, show), {0.6, 0.8, 1, 0.4});
  expectNear(of(sum + R"(, "bias": -0.5)", show), {0.1, 0.3, 0.5, 0.4});
  expectNear(of(sum + R"(, "bias": -0.5, "scale": 2)", show), {0.2, 0.6, 1, 0.4});
  expectNear(of(sum + R"(, "bias": -0.5, "scale": 4)", show), {0.4, 1, 1, 0.4});
  expectNear(of(sum + R"(, "scale": 0.5)", show), {0.3, 0.4, 0.5, 0.4});
  // -1 x 4 stays at -1: inverted again it is 1 + 1 - 1
  expectNear(of(R"("A": "signed primary", "B": "one", "AB": "spare0", "scale": 4)", show), {1, 0, 0, 0.4});
}

TEST(CombinerValues, DotProductReachesAlphaAsBlue) {
  // (0.5, -0.25, -1).(0.2, 0.4, 0.6) = 0.1 - 0.1 - 0.6 = -0.6, negated by the second product
  expectNear(
      of(R"("A": "negate primary", "B": "secondary", "A.B": "spare0", "C": "secondary", "D": "secondary", "C.D": "spare1")",
         R"("A": "spare0", "B": "spare1", "G": "spare0.blue")"),
      {0.6 * 0.56, 0.6 * 0.56, 0.6 * 0.56, 0.6});
}

TEST(CombinerValues, PortionsReadWhatWasBeforeTheStage) {
  const Result<Combiner> c = parseCombiner(R"({"schema": 1, "title": "t",
    "inputs": {"primary": [0.5, 0.5, 0.5, 0.25]},
    "stages": [{"rgb": {"A": "primary.alpha", "B": "one", "AB": "primary"},
                "alpha": {"A": "primary.blue", "B": "one", "AB": "primary"}}],
    "final": {"D": "primary", "G": "primary"}})",
                                           "t");
  ASSERT_TRUE(c.ok()) << c.error().text();
  // They change places: neither sees what the other has written.
  expectNear(combine(*c, filledRegisters(*c, {})), {0.25, 0.25, 0.25, 0.5});
}

TEST(CombinerValues, FinalStageWithItsProduct) {
  const std::string stage = R"("A": "secondary", "B": "one", "AB": "spare0")";
  // A = 0.4, B = E F = spare0 squared, C = inverted secondary, D = secondary
  const glm::dvec4 got =
      of(stage, R"("A": "primary.alpha", "B": "E*F", "C": "inverted secondary", "D": "secondary",
    "E": "spare0", "F": "spare0", "G": "inverted primary")");
  expectNear(got,
             {0.4 * 0.04 + 0.6 * 0.8 + 0.2, 0.4 * 0.16 + 0.6 * 0.6 + 0.4, 0.4 * 0.36 + 0.6 * 0.4 + 0.6, 0.6});
  expectNear(of(stage, R"("C": "E*F", "D": "one", "E": "spare0", "F": "spare0", "G": "zero")"), {1, 1, 1, 0});
}

TEST(CombinerValues, RegistersAreHeldToMinusOneToOne) {
  Filling f = lit();
  f[Register::Primary] = {3, -2, 1, 0};
  f[Register::Spare0] = f[Register::Zero] = f[Register::Product] = glm::dvec4(0.7);  // not looked at
  expectNear(combine(shipped("iso"), f.r), {0.56, 0.2, 0.51, 0.7});
}

TEST(CombinerValues, InputsFillTheirPartsOnly) {
  const Combiner c = shipped("iso");
  EXPECT_EQ(textureCount(c), 2u);
  EXPECT_EQ(sliceCount(c), 2u);
  EXPECT_EQ(lightCount(c), 1u);
  EXPECT_EQ(lightCount(shipped("iso-two-colours")), 2u);
  EXPECT_EQ(textureCount(shipped("four-slices")), 4u);
  EXPECT_EQ(sliceCount(shipped("shaded-per-voxel")), 1u);  // two textures of one slice
  EXPECT_EQ(lightCount(shipped("strip")), 0u);
  const Registers r = filledRegisters(c, [](const Input& in) {
    return in.what == Quantity::Interpolation ? glm::dvec4(0.25) : glm::dvec4(1, 2, 3, 4);
  });
  EXPECT_EQ(r[placeOf(Register::Constant0)], glm::dvec4(0, 0, 0, 0.25));
  EXPECT_EQ(r[placeOf(Register::Constant1)], glm::dvec4(1, 2, 3, 0));
  EXPECT_EQ(r[placeOf(Register::Texture0)], glm::dvec4(1, 2, 3, 4));
  EXPECT_EQ(r[placeOf(Register::Texture0, 2)], glm::dvec4(0));
}

}  // namespace
}  // namespace vernier::dvr
