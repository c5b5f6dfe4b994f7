// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of rays as the techniques of this plugin draw them: GL as native, a lens that changes nothing is not
// seen, and which layers cannot be cut.
#include "ProjectionCases.h"
#include "ProjectionParams.h"
#include "RaysForTest.h"

namespace vernier::test {
namespace {

using Which = RaysOfPass::Which;

// The layer's pass, drawn for both appearances of a picture with one lens.
struct Parts {
  Images images;
  Accumulator accumulator = Accumulator::Ordered;
};

Parts drawParts(const LookCase& c, const std::string& technique, float toolWeight = 1) {
  Parts out;
  const Result<Plan> plan = c.plan(technique);
  EXPECT_TRUE(plan.ok()) << (plan.ok() ? "" : plan.error().text());
  Pass pass = plan->passes.at(0);
  out.accumulator = pass.accumulator;
  const auto& params = dynamic_cast<const angiography::ProjectionParams&>(*pass.params);
  const native::ProjectionJob& job = params.job;
  const PatientPoint at = c.sources.volumes.at("v")->grid().centre() + PatientVec(0.3, 0.2, 0.1);
  out.images.rays = cutRays(job.camera, job.region, turnedBox(at, {4.1, 3.3, 5.2}));
  for (std::size_t p = 0; p + 1 < out.images.rays->first.size(); ++p)
    for (RaySegment& s : out.images.rays->of(p).subspan(out.images.rays->meetsLens(p) ? 1 : 0))
      s.weight = toolWeight;
  const Technique* t = LookHost::instance().registry.find(technique);
  EXPECT_TRUE(t->drawsParts);
  for (const std::int16_t appearance : {std::int16_t{0}, std::int16_t{1}}) {
    pass.rays = {Which::All, appearance};
    const Result<void> done = t->execute(pass, out.images, {});
    EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().text());
  }
  return out;
}

TEST(ProjectionPartsGl, AsNativeDrawsThem) {
  VERNIER_NEEDS_GL(device);
  for (const ProjectionMode mode : kAllModes)
    for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
      for (const float weight : {1.0f, 0.4f}) {
        LookCase c;
        c.layer().mode = mode;
        c.scene.camera.projection = projection;
        const Parts gl = drawParts(c, "projection.gl", weight),
                    native = drawParts(c, "projection.native", weight);
        EXPECT_EQ(gl.accumulator, native.accumulator);
        ASSERT_EQ(gl.images.rays->segments.size(), native.images.rays->segments.size());
        int covered = 0;
        for (std::size_t n = 0; n < gl.images.rays->segments.size(); ++n) {
          const RaySegment &a = gl.images.rays->segments[n], &b = native.images.rays->segments[n];
          ASSERT_EQ(a.covered, b.covered) << n;
          covered += a.covered ? 1 : 0;
          if (a.covered) {
            EXPECT_NEAR(a.colour[1], b.colour[1], 2e-5) << static_cast<int>(mode);
          }
        }
        EXPECT_GT(covered, 300);
        for (std::size_t n = 0; n < gl.images.colour.size(); ++n)
          ASSERT_NEAR(gl.images.colour[n], native.images.colour[n], 2e-5);
      }
}

TEST(ProjectionPartsGl, ALensThatChangesNothingIsNotSeen) {
  for (const char* technique : {"projection.gl", "projection.native", "projection.exact"})
    for (const ProjectionMode mode : kAllModes) {
      if (mode == ProjectionMode::Mean || (!glDevice() && std::string(technique) == "projection.gl"))
        continue;
      LookCase c;
      c.layer().mode = mode;
      const Images whole = c.draw(technique).images;
      const Parts parts = drawParts(c, technique);
      double most = 0;
      for (std::size_t p = 0; p < whole.depth.size(); ++p)
        if (parts.images.rays->meetsLens(p))
          most = std::max(most, std::abs(joined(*parts.images.rays, p, parts.accumulator, glm::dvec3(0)).y -
                                         static_cast<double>(whole.colour[4 * p + 1])));
      EXPECT_LT(most, std::string(technique) == "projection.exact" ? 1e-6 : 1e-5)
          << technique << " " << static_cast<int>(mode);
    }
}

TEST(ProjectionPartsGl, WhatIsTurnedOverDoesNotAddUp) {
  LookCase c;
  auto region = std::make_shared<ConvexRegion>();
  const LookHost& host = LookHost::instance();
  const Quality quality;
  const CostTable costs;
  PlanContext context{c.scene, c.view, quality, host.capabilities, costs, c.sources};
  for (const char* technique : {"projection.native", "projection.exact", "projection.gl"}) {
    if (!glDevice() && std::string(technique) == "projection.gl") continue;
    for (const ProjectionMode mode : kAllModes) {
      c.layer().mode = mode, c.layer().invert = true;
      context.lenses = {{region, 1}};
      const auto cut = host.registry.find(technique)->passesFor(c.scene.layers[0], 0, context);
      const bool extreme = angiography::isExtreme(mode);
      ASSERT_EQ(cut.ok(), extreme) << technique << static_cast<int>(mode);
      if (extreme) {
        EXPECT_EQ(cut->front().accumulator,
                  mode == ProjectionMode::Max ? Accumulator::Min : Accumulator::Max);
      } else {
        EXPECT_EQ(cut.error().code, ErrorCode::NoTechnique);
      }
      context.lenses.clear();
      EXPECT_TRUE(host.registry.find(technique)->passesFor(c.scene.layers[0], 0, context).ok());
    }
  }
}

}  // namespace
}  // namespace vernier::test
