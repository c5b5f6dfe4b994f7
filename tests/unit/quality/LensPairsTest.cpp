// SPDX-License-Identifier: GPL-3.0-or-later
// The reference with a lens: every pair of the algebra on four voxels by hand.
#include "PairsOfTheAlgebra.h"
#include "VolumeScenes.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

ReferenceOptions optionsOf(const algebra::Case& c) {
  ReferenceOptions o;
  o.lenses = c.lenses;
  return o;
}

TEST(LensPairs, AllByHand) {
  const auto cases = algebra::pairs();
  EXPECT_EQ(cases.size(), 10u * 11 * 4);
  for (const algebra::Case& c : cases) {
    SCOPED_TRACE(c.name);
    std::vector<std::size_t> at;
    for (const auto& p : c.pixels) at.push_back(p.index);
    const auto got = referencePixels(c.scene, c.view, c.sources, at, optionsOf(c));
    ASSERT_TRUE(got.ok()) << got.error().text();
    for (std::size_t n = 0; n < at.size(); ++n)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR((*got)[n].rgba[k], c.pixels[n].colour[k], 2e-7) << "pixel " << n << " channel " << k;
  }
}

// Anchors of the table itself, in plain numbers.
TEST(LensPairs, TheTableInPlainNumbers) {
  using algebra::answer;
  using algebra::Kind;
  using algebra::With;
  const auto expect = [](glm::dvec3 got, glm::dvec3 is) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], is[k], 1e-12);
  };
  // 0.25 of the outside, 15/16 of the inside, and what is left of the second quarter over the background.
  const double l = 0.75 / 16;
  expect(answer(Kind::Blend, Kind::Blend, With::Nothing, true),
         {0.25 + 0.25 * l + 0.75 * l * 0.1, 0.125 + 0.75 * 15 / 32 + 0.125 * l + 0.75 * l * 0.2,
          0.75 * 15 / 16 + 0.75 * l * 0.3});
  // 0.6 outside against 1.25 * 0.8 inside; beside the lens 0.8.
  expect(answer(Kind::Max, Kind::Max, With::Nothing, true), {1, 1, 1});
  expect(answer(Kind::Max, Kind::Max, With::Nothing, false), {0.8, 0.8, 0.8});
  expect(answer(Kind::Max, Kind::CutOut, With::Nothing, true), {0.6, 0.6, 0.6});
  expect(answer(Kind::Max, Kind::CutOut, With::Opaque, true), {0.5, 0.5, 0.9});
  expect(answer(Kind::Min, Kind::Min, With::Nothing, true), {0.2, 0.2, 0.2});
  // Half of the tool, and half of 0.6 behind it against 0.5 before it.
  expect(answer(Kind::Max, Kind::CutOut, With::Translucent, true), {0.6, 0.7, 0.95});
  // 0.1 * (0.35 + 0.55) + 0.125 * (0.65 + 0.7 + 0.95)
  expect(answer(Kind::Sum, Kind::Sum, With::Nothing, true), {0.3775 + 0.1, 0.3775 + 0.2, 0.3775 + 0.3});
  const double x = std::exp(-0.3775);
  expect(answer(Kind::Attenuation, Kind::Attenuation, With::Nothing, true), {x, x, x});
  const double tool = std::exp(-0.035 - 0.125 * 1.35) * 0.5;
  expect(answer(Kind::Attenuation, Kind::Attenuation, With::Translucent, true),
         {0.5 * x + 0.2 * tool, 0.5 * x + 0.4 * tool, 0.5 * x + 0.9 * tool});
  // A maximum behind a blended inside, and inside a blended outside.
  expect(answer(Kind::Max, Kind::Blend, With::Nothing, true),
         {0.6 / 16, 0.5 * 15 / 16 + 0.6 / 16, 15.0 / 16 + 0.6 / 16});
  expect(answer(Kind::Blend, Kind::Max, With::Nothing, true), {0.4375 + 0.5625, 0.4375 / 2 + 0.5625, 0.5625});
  // The inside's surface, that behind the lens, and what a clip plane makes of the former.
  expect(answer(Kind::Iso, Kind::Iso, With::Nothing, true), {1, 1, 0});
  expect(answer(Kind::Iso, Kind::CutOut, With::Nothing, true), {0, 1, 0});
  expect(answer(Kind::Iso, Kind::CutOut, With::Opaque, true), {0.2, 0.4, 0.9});
  // Two crossings of 0.55 behind the lens; four of 0.45 and two of 0.7 in it.
  expect(answer(Kind::ShellsSum, Kind::CutOut, With::Nothing, true), {0.22, 0.22, 0.22});
  expect(answer(Kind::ShellsSum, Kind::ShellsSum, With::Nothing, true),
         {0.22 + 0.25 * 3.2, 0.22 + 0.125 * 3.2, 0.22 + 0.0625 * 3.2});
  // The outside reaches no level before the tool; the inside does, and shows instead of it.
  expect(answer(Kind::ShellsMax, Kind::CutOut, With::Opaque, true), {0.2, 0.4, 0.9});
  expect(answer(Kind::ShellsMax, Kind::ShellsMax, With::Opaque, true), {1, 0.5, 0.25});
  // A mean of the outside under one of the inside, the latter shows.
  expect(answer(Kind::Mean, Kind::Mean, With::Nothing, true), {0.71875, 0.71875, 0.71875});
}

}  // namespace
}  // namespace vernier::quality
