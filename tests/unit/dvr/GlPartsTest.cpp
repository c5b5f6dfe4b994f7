// SPDX-License-Identifier: GPL-3.0-or-later
// dvr.rays on parts of rays: a lens that changes nothing is not seen and costs two steps a ray; what is
// inside a lens is what its faces as clip planes would leave.
#include "GlCases.h"
#include "RaysForTest.h"

namespace vernier::test {
namespace {

using Which = RaysOfPass::Which;

constexpr int kLooks = 6;
DvrCase look(int n, Projection projection) {
  DvrCase c(bumpyVolume(), n >= 4);
  c.scene.camera.projection = projection;
  if (n == 1) c.layer().classification = Classification::PreIntegrated;
  if (n == 2) c.layer().classification = Classification::Pre;
  if (n == 3) c.layer().shading = ShadingModel::ColourPerVoxel;
  if (n == 5) c.iso().level = 120;
  return c;
}

const char* const kNames[kLooks] = {"post", "pre-integrated", "pre", "shaded", "surface", "another surface"};

std::vector<HalfSpace> lensOf(const DvrCase& c) {
  return turnedBox(c.volume().grid().centre() + PatientVec(-0.6, 0.4, 0.7), {5.3, 6.1, 4.2});
}

Images drawParts(const DvrCase& c, std::initializer_list<RaysOfPass> passes, bool fromBackground = true) {
  Images images;
  const Result<Plan> plan = c.plan("dvr.rays");
  EXPECT_TRUE(plan.ok()) << (plan.ok() ? "" : plan.error().text());
  const std::vector<HalfSpace> region = *keptRegion(c.scene, c.volume().grid());
  images.rays = cutRays(c.camera(), region, lensOf(c));
  Pass pass = plan->passes.at(0);
  EXPECT_EQ(pass.accumulator, Accumulator::Ordered);
  const Technique* t = DvrHost::instance().registry.find("dvr.rays");
  EXPECT_TRUE(t->drawsParts);
  for (const RaysOfPass& which : passes) {
    pass.rays = which;
    const Result<void> done = t->execute(pass, images, {});
    EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().text());
  }
  EXPECT_EQ(images.colour.empty(), !fromBackground);
  return images;
}

std::uint64_t raysThroughLens(const RayIntervals& rays) {
  std::uint64_t n = 0;
  for (std::size_t p = 0; p + 1 < rays.first.size(); ++p) n += rays.meetsLens(p) ? 1 : 0;
  return n;
}

TEST(GlParts, ALensThatChangesNothingIsNotSeen) {
  VERNIER_NEEDS_GL(device);
  for (int n = 0; n < kLooks; ++n)
    for (const Projection projection : kBothProjections) {
      SCOPED_TRACE(kNames[n]);
      const DvrCase c = look(n, projection);
      const Images whole = *c.draw("dvr.rays");
      const Images parts = drawParts(c, {{Which::First, 0}, {Which::All, 1}, {Which::Rest, 0}});
      const RayIntervals& rays = *parts.rays;
      const std::uint64_t through = raysThroughLens(rays);
      EXPECT_GT(through, 300u);
      const glm::dvec3 background(c.scene.background.r, c.scene.background.g, c.scene.background.b);
      std::size_t off = 0;
      for (std::size_t p = 0; p < whole.depth.size(); ++p) {
        const glm::dvec3 truth(whole.colour[4 * p], whole.colour[4 * p + 1], whole.colour[4 * p + 2]);
        if (!rays.meetsLens(p)) {
          ASSERT_EQ(parts.colour[4 * p], whole.colour[4 * p]);
          ASSERT_EQ(parts.depth[p], whole.depth[p]);
          continue;
        }
        const glm::dvec3 change = glm::abs(joinedInOrder(rays, p, background) - truth);
        off += std::max({change.x, change.y, change.z}) > 0.25 / 255 ? 1 : 0;
        float depth = kNothing_mm;
        for (const RaySegment& s : rays.of(p))
          if (s.hasDepth) depth = std::min(depth, s.depth_mm);
        if (std::isfinite(depth) && std::isfinite(whole.depth[p])) {
          EXPECT_NEAR(depth, whole.depth[p], 0.5 * c.step_mm());  // GL's stands at a step's middle
        }
      }
      EXPECT_EQ(off, 0u);
      // Reads of a step: a gradient takes six more, an integrated one its other end.
      const std::uint64_t perStep = n == 3 ? 7 : n == 1 ? 2 : 1;
      EXPECT_LE(parts.counters.samples, whole.counters.samples + 2 * perStep * through);
      EXPECT_GT(parts.counters.samples + parts.counters.cells, 0u);
    }
}

TEST(GlParts, InsideALensStandsWhatItsPlanesWouldLeave) {
  VERNIER_NEEDS_GL(device);
  for (int n = 0; n < kLooks; ++n)
    for (const Projection projection : kBothProjections) {
      SCOPED_TRACE(kNames[n]);
      DvrCase c = look(n, projection);
      const Images parts = drawParts(c, {{Which::All, 1}}, false);
      c.scene.clip = lensOf(c);
      const Images clipped = *c.draw("dvr.rays");
      const glm::dvec3 background(c.scene.background.r, c.scene.background.g, c.scene.background.b);
      int compared = 0, lit = 0, off = 0;
      for (std::size_t p = 0; p < clipped.depth.size(); ++p) {
        if (!parts.rays->meetsLens(p)) continue;
        const glm::dvec3 truth(clipped.colour[4 * p], clipped.colour[4 * p + 1], clipped.colour[4 * p + 2]);
        ++compared;
        lit += glm::length(truth - background) > 0.05 ? 1 : 0;
        off += glm::length(joinedInOrder(*parts.rays, p, background) - truth) > 1e-3 ? 1 : 0;
        for (const RaySegment& s : parts.rays->of(p)) {
          if (s.appearance == 0) {
            EXPECT_FALSE(s.covered);
          }
        }
      }
      EXPECT_GT(compared, 300);
      EXPECT_GT(lit, 60);
      EXPECT_EQ(off, 0);
    }
}

TEST(GlParts, ExtremesAreLeftToProjections) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  c.layer().mode = VolumeMode::Max;
  const DvrHost& host = DvrHost::instance();
  const CostTable costs;
  PlanContext context{c.scene, c.view, c.quality, host.capabilities, costs, c.sources};
  const Technique* t = host.registry.find("dvr.rays");
  EXPECT_TRUE(t->passesFor(c.scene.layers[0], 0, context).ok());
  context.appearances.resize(2);
  EXPECT_EQ(t->passesFor(c.scene.layers[0], 0, context).error().code, ErrorCode::NoTechnique);
}

}  // namespace
}  // namespace vernier::test
