// SPDX-License-Identifier: GPL-3.0-or-later
// One ray's parts joined by hand: colour and depth.
#include "vernier/native/LensRays.h"

#include <gtest/gtest.h>

namespace vernier::native {
namespace {

constexpr std::int16_t kTool = RaySegment::kTool, kEnd = RaySegment::kEnd;

RaySegment ordered(float at_mm, std::int16_t appearance, float grey, float through) {
  RaySegment s;
  s.from_mm = at_mm, s.to_mm = at_mm + 1, s.appearance = appearance;
  s.colour.fill(grey), s.through = through, s.depth_mm = at_mm + 0.25f, s.hasDepth = true;
  return s;
}
RaySegment gathered(float at_mm, std::int16_t appearance, float grey) {
  RaySegment s = ordered(at_mm, appearance, grey, 1);
  s.covered = true;
  return s;
}
RaySegment tool(float at_mm, float grey, float through) {
  RaySegment s = ordered(at_mm, through > 0 ? kTool : kEnd, grey, through);
  s.to_mm = at_mm, s.hasDepth = false;
  return s;
}

struct Seen {
  float grey = 0, depth_mm = 0;
};
Seen joined(const JoinJob& job, std::vector<RaySegment> segments) {
  Images images;
  images.allocate(1, 1, false);
  images.rays = std::make_shared<RayIntervals>();
  images.rays->width = images.rays->height = 1;
  images.rays->first = {0, static_cast<std::uint32_t>(segments.size())};
  images.rays->segments = std::move(segments);
  EXPECT_TRUE(joinParts(job, images).ok());
  EXPECT_FALSE(images.rays);
  EXPECT_EQ(images.colour[0], images.colour[2]);
  EXPECT_EQ(images.colour[3], 1);
  return {images.colour[0], images.depth[0]};
}
void expectSeen(const Seen& s, double grey, float depth_mm) {
  EXPECT_NEAR(s.grey, grey, 1e-6);
  EXPECT_EQ(s.depth_mm, depth_mm);
}

JoinJob jobOf(std::vector<Accumulator> accumulators) {
  JoinJob job;
  job.overBackground.assign(accumulators.size(), true);
  job.accumulators = std::move(accumulators);
  job.background = glm::dvec3(0.1);
  return job;
}

using enum Accumulator;

TEST(LensJoin, AnExtremeStandsWhereItIsFound) {
  for (const bool reversed : {false, true}) {
    const float near = reversed ? 0.7f : 0.3f, far = reversed ? 0.3f : 0.7f;
    const std::vector<RaySegment> parts{gathered(5, 0, near), gathered(8, 1, far)};
    expectSeen(joined(jobOf({Max, Max}), parts), 0.7, reversed ? 5.25f : 8.25f);
    expectSeen(joined(jobOf({Min, Min}), parts), 0.3, reversed ? 8.25f : 5.25f);
  }
}

TEST(LensJoin, SumsAndWhatAttenuatesBeginAtTheirFirstPart) {
  // Depths need not ascend: a sum of shells says the mean place of its crossings.
  for (const bool reversed : {false, true}) {
    std::vector<RaySegment> parts{gathered(5, 0, 0.2f), gathered(8, 1, 0.3f)};
    if (reversed) std::swap(parts[0].depth_mm, parts[1].depth_mm);
    expectSeen(joined(jobOf({Sum, Sum}), parts), 0.2 + 0.3 + 0.1, 5.25f);
    expectSeen(joined(jobOf({Attenuation, Attenuation}), parts), 0.2 * 0.3, 5.25f);
  }
}

TEST(LensJoin, WhatIsGatheredHasNoDepthBehindHalfOfTheLight) {
  expectSeen(joined(jobOf({Max, Ordered}), {ordered(2, 1, 0.5f, 0.4f), gathered(5, 0, 0.5f)}),
             0.5 + 0.4 * 0.5, 2.25f);
  expectSeen(joined(jobOf({Max, Ordered}), {ordered(2, 1, 0.2f, 0.6f), gathered(5, 0, 0.5f)}),
             0.2 + 0.6 * 0.5, 5.25f);
}

TEST(LensJoin, AToolIsWhereHalfOfTheLightEnds) {
  // Of two the first that takes the half; the opaque one only where none did.
  expectSeen(joined(jobOf({Ordered}), {ordered(1, 0, 0.1f, 0.9f), tool(3, 0.2f, 0.3f), tool(6, 0.8f, 0)}),
             0.1 + 0.9 * 0.2 + 0.9 * 0.3 * 0.8, 3);
  expectSeen(joined(jobOf({Ordered}), {ordered(1, 0, 0.1f, 0.9f), tool(6, 0.8f, 0)}), 0.1 + 0.9 * 0.8, 6);
}

TEST(LensJoin, ShellsReplaceAToolOrAreSeenWhereTheyAreBrighter) {
  JoinJob job = jobOf({Max, Max});
  job.replaces = {true, false}, job.least = {glm::dvec3(0.3), glm::dvec3(0)};
  const auto before = [&](std::int16_t appearance, float grey) {
    return joined(job, {gathered(2, appearance, grey), tool(6, 0.5f, 0)});
  };
  expectSeen(before(0, 0.2f), 0.2, 2.25f);  // however dark, and no least before a tool
  expectSeen(before(0, 0), 0, 2.25f);
  expectSeen(before(1, 0.2f), 0.5, 6);
  expectSeen(before(1, 0.7f), 0.7, 2.25f);
}

TEST(LensJoin, TheLeastOfShellsIsShownBehindAllTools) {
  JoinJob job = jobOf({Max, Ordered});
  job.least = {glm::dvec3(0.3), glm::dvec3(0)};
  expectSeen(joined(job, {gathered(2, 0, 0.2f)}), 0.3, 2.25f);
  expectSeen(joined(job, {gathered(2, 0, 0.1f), tool(3, 0.2f, 0.5f)}), 0.2 + 0.5 * 0.3, 2.25f);
  // Nothing gathered: the brighter of both.
  const RaySegment inside = ordered(2, 1, 0.1f, 0.8f);
  expectSeen(joined(job, {inside}), 0.1 + 0.8 * 0.3, kNothing_mm);
  job.background = glm::dvec3(0.4);
  expectSeen(joined(job, {inside}), 0.1 + 0.8 * 0.4, kNothing_mm);
}

TEST(LensJoin, ToolsAreWeakenedByWhatAttenuatesBeforeThem) {
  const JoinJob job = jobOf({Attenuation, Attenuation, Ordered});
  expectSeen(joined(job, {gathered(1, 0, 0.5f), tool(3, 0.2f, 0.6f), gathered(4, 1, 0.7f)}),
             0.5 * 0.2 + 0.6 * 0.5 * 0.7, 1.25f);
  // Ordered parts are not: what is gathered is their background.
  expectSeen(joined(job, {gathered(1, 0, 0.5f), ordered(3, 2, 0.2f, 0.6f)}), 0.2 + 0.6 * 0.5, 1.25f);
  // Nothing weakens the light: it is white.
  expectSeen(joined(job, {ordered(3, 2, 0.2f, 0.6f)}), 0.2 + 0.6, kNothing_mm);
}

TEST(LensJoin, OfWhatCannotBeJoinedTheLastInTheScenesOrderShows) {
  const std::vector<RaySegment> parts{gathered(1, 1, 0.6f), gathered(3, 0, 0.2f), gathered(5, 1, 0.9f)};
  expectSeen(joined(jobOf({Max, Attenuation}), parts), 0.6 * 0.9, 1.25f);
  expectSeen(joined(jobOf({Attenuation, Max}), parts), 0.9, 5.25f);
  expectSeen(joined(jobOf({Mean, Mean}), {gathered(1, 0, 0.6f), gathered(3, 1, 0.2f)}), 0.2, 3.25f);
}

}  // namespace
}  // namespace vernier::native
