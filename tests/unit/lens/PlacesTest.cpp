// SPDX-License-Identifier: GPL-3.0-or-later
// Where a lens may stand: outside, behind the eye, around it, around everything, thinner than a voxel. The
// volume is that of PairsOfTheAlgebra.h: its box reaches from y = 0 to 6 mm, the eye looks along y.
#include "LensHost.h"

namespace vernier::lens {
namespace {

using namespace vernier::test;
using algebra::Kind;
using algebra::With;

algebra::Case caseOf(Kind outside, Kind inside, const BoxShape& box) {
  algebra::Case c = algebra::makeCase(outside, inside, With::Nothing, algebra::fourVoxels());
  std::get<LensLayer>(c.scene.layers.back()).shape = box;
  return c;
}

struct Drawn {
  Plan plan;
  Images images;
};
Drawn drawn(const algebra::Case& c) {
  const LensHost host;
  Result<Plan> plan = host.plan(c.scene, c.view, c.sources);
  EXPECT_TRUE(plan.ok()) << plan.error().text();
  if (!plan) return {};
  Result<Images> images = host.draw(*plan);
  EXPECT_TRUE(images.ok());
  return {*plan, *images};
}

void expectSame(const Images& a, const Images& b, double within) {
  ASSERT_EQ(a.colour.size(), b.colour.size());
  for (std::size_t n = 0; n < a.colour.size(); ++n)
    EXPECT_NEAR(static_cast<double>(a.colour[n]), static_cast<double>(b.colour[n]), within) << n;
}

// The picture is as without the lens, bit by bit, and so is the plan but for a note that says why.
void expectNotThere(const algebra::Case& c) {
  algebra::Case without = c;
  without.scene.layers.pop_back();
  const Drawn with = drawn(c), plain = drawn(without);
  ASSERT_EQ(with.plan.passes.size(), plain.plan.passes.size());
  for (std::size_t n = 0; n < plain.plan.passes.size(); ++n)
    EXPECT_EQ(with.plan.passes[n].params->dump(), plain.plan.passes[n].params->dump());
  ASSERT_FALSE(with.plan.notes.empty());
  EXPECT_NE(with.plan.notes.front().find("(lens) lies outside what is seen"), std::string::npos);
  EXPECT_EQ(with.images.colour, plain.images.colour);
}

TEST(LensPlaces, G6_OutsideTheVolumeThereIsNone) {
  for (Kind kind : {Kind::Blend, Kind::Max, Kind::Iso})
    expectNotThere(caseOf(kind, Kind::CutOut, {MeshPoint(0, 20, 0), {5, 5, 5}}));
}

TEST(LensPlaces, G6_BehindTheEyeThereIsNone) {
  algebra::Case c = caseOf(Kind::Blend, Kind::CutOut, {MeshPoint(0, 1, 0), {5, 1, 5}});
  c.scene.camera.distance_mm = 1;  // the eye plane at y = 2
  expectNotThere(c);
  c.scene.camera.distance_mm = 13, c.scene.camera.near_mm = 12;  // nothing before y = 2 is seen
  expectNotThere(c);
}

TEST(LensPlaces, G6_AroundTheEyeItIsAsIfCutThere) {
  const BoxShape box{MeshPoint(5.5, 3, 0), {10, 4, 20}};
  algebra::Case inside = caseOf(Kind::Blend, Kind::Blend, box);
  algebra::Case clipped = inside;
  inside.scene.camera.distance_mm = 1;  // y = 2, in the lens
  clipped.scene.clip.push_back({PatientVec(0, -1, 0), -2});
  const Drawn a = drawn(inside), b = drawn(clipped);
  expectSame(a.images, b.images, 1e-6);
  // And the lens is seen: without it the picture is another.
  inside.scene.layers.pop_back();
  EXPECT_NE(drawn(inside).images.colour, a.images.colour);
}

TEST(LensPlaces, G6_AroundTheVolumeOnlyTheInsideIsSeen) {
  for (Kind kind : {Kind::Blend, Kind::Iso, Kind::Min}) {
    const algebra::Case c = caseOf(Kind::Max, kind, {MeshPoint(0, 3, 0), {900, 900, 900}});
    algebra::Case alone = c;
    alone.scene.layers = {std::visit(
        [](const auto& l) -> Layer {
          if constexpr (std::is_constructible_v<Layer, decltype(l)>)
            return l;
          else
            return CustomLayer{};
        },
        std::get<LensLayer>(c.scene.layers.back()).inner)};
    expectSame(drawn(c).images, drawn(alone).images, 1e-6);
  }
}

TEST(LensPlaces, G6_ThinnerThanAVoxelItTakesItsShare) {
  const double thin = 0.01;
  const algebra::Case c = caseOf(Kind::Blend, Kind::CutOut, {MeshPoint(0, 3, 0), {900, thin, 900}});
  algebra::Case without = c;
  without.scene.layers.pop_back();
  const Drawn with = drawn(c), plain = drawn(without);
  // Beside the lens there is nothing: every ray passes it and loses 0.01 mm of 6 of its opacity, 0.25 per mm.
  const double left = std::pow(0.75, 6);
  const double expected = (1 - std::pow(0.75, 6 - thin)) - (1 - left);
  for (std::size_t pixel = 0; pixel < 16; ++pixel) {
    const double red = static_cast<double>(with.images.colour[4 * pixel]) -
                       static_cast<double>(plain.images.colour[4 * pixel]);
    // Red is 1 within, 0.1 behind.
    EXPECT_NEAR(red, 0.9 * expected, 2e-5) << pixel;
  }
}

}  // namespace
}  // namespace vernier::lens
