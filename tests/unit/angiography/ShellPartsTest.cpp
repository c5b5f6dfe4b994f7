// SPDX-License-Identifier: GPL-3.0-or-later
// Shells on parts of rays: the part inside a lens is what the lens's planes would leave of the picture as
// clip planes, caps and all; a tool that cuts a ray opens nothing.
#include "RaysForTest.h"
#include "ShellCases.h"

namespace vernier::test {
namespace {

using Which = RaysOfPass::Which;
constexpr ShellsMode kModes[] = {ShellsMode::Max, ShellsMode::Sum, ShellsMode::Lit};

struct PartsCase : ShellCase {
  PartsCase(ShellsMode mode, double a, Projection projection) {
    scene.camera.projection = projection;
    shells().mode = mode, shells().a = a, shells().b = 0.4;
  }
  PatientPoint middle() const { return sources.volumes.at("v")->grid().centre(); }
};

Images drawn(const native::ShellsJob& job, std::shared_ptr<RayIntervals> rays = nullptr) {
  Images images;
  images.rays = std::move(rays);
  const Result<void> done = native::drawShells(job, images, {});
  EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().text());
  return images;
}

glm::dvec3 colourOf(const Images& images, std::size_t p) {
  return {images.colour[4 * p], images.colour[4 * p + 1], images.colour[4 * p + 2]};
}

// What is joined, with Lit shells in front of all that lies behind them.
glm::dvec3 partsOf(const native::ShellsJob& job, const RayIntervals& rays, std::size_t p) {
  if (job.mode != ShellsMode::Lit)
    return joined(rays, p, job.mode == ShellsMode::Max ? Accumulator::Max : Accumulator::Sum, glm::dvec3(0));
  for (const RaySegment& s : rays.of(p))
    if (s.covered) return {s.colour[0], s.colour[1], s.colour[2]};
  return job.background;
}

template <class Fn>
void eachLook(Fn&& fn) {
  for (const ShellsMode mode : kModes)
    for (const double a : {0.0, 0.6})
      for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
        SCOPED_TRACE(std::to_string(static_cast<int>(mode)) + " " + std::to_string(a) +
                     (projection == Projection::Perspective ? " perspective" : ""));
        fn(PartsCase(mode, a, projection));
      }
}

// Pixels through the lens against the same part of the volume, left alone by clip planes.
void expectAsClipped(const PartsCase& c, const std::vector<HalfSpace>& lens,
                     const std::vector<HalfSpace>& left, std::int16_t appearance) {
  native::ShellsJob job = c.job();
  const auto rays = cutRays(job.camera, job.kept, lens);
  auto region = std::make_shared<ConvexRegion>();
  region->planes = lens;
  job.lenses = {region};
  job.rays = {Which::All, appearance};
  drawn(job, rays);
  native::ShellsJob clipped = c.job();
  clipped.kept.insert(clipped.kept.end(), left.begin(), left.end());
  const Images truth = drawn(clipped);
  int compared = 0, lit = 0, off = 0;
  for (std::size_t p = 0; p < truth.depth.size(); ++p) {
    const auto of = rays->of(p);
    const auto own =
        std::count_if(of.begin(), of.end(), [&](const RaySegment& s) { return s.appearance == appearance; });
    if (own != 1) continue;
    ++compared;
    const glm::dvec3 got = partsOf(job, *rays, p), wanted = colourOf(truth, p);
    lit += wanted.x > 0 ? 1 : 0;
    // Ends in float: a value within 1e-5 of a level may fall to the other side of it.
    off += glm::length(got - wanted) > 1e-4 ? 1 : 0;
    for (const RaySegment& s : of)
      if (s.appearance == appearance && s.covered && glm::length(got - wanted) < 1e-4) {
        EXPECT_NEAR(s.depth_mm, truth.depth[p], 2e-3);
      }
  }
  EXPECT_GT(compared, 150);
  EXPECT_GT(lit, 60);
  EXPECT_EQ(off, 0);
}

TEST(ShellParts, InsideALensStandsWhatItsPlanesWouldLeave) {
  eachLook([](const PartsCase& c) {
    const auto lens = turnedBox(c.middle() + PatientVec(0.3, 0.2, 0.1), {4.1, 3.3, 5.2});
    expectAsClipped(c, lens, lens, 1);
  });
}

TEST(ShellParts, OutsideAHalfSpaceStandsWhatTheOtherHalfWouldLeave) {
  eachLook([](const PartsCase& c) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(0.4, 0.8, 0.2));
    const double at = glm::dot(n, c.middle().p) - 0.7;
    expectAsClipped(c, {{PatientVec(n), at}}, {{PatientVec(-n), -at}}, 0);
  });
}

// A ray cut by a tool that lets everything through shows what the whole ray does; one that lets half of it
// through dims what lies behind.
TEST(ShellParts, ToolsOpenNothing) {
  eachLook([](const PartsCase& c) {
    native::ShellsJob job = c.job();
    const Images whole = drawn(job);
    for (const float weight : {1.0f, 0.5f}) {
      auto rays = cutRays(job.camera, job.kept, turnedBox(c.middle(), {5, 5, 5}));
      auto cut = std::make_shared<RayIntervals>();
      cut->width = rays->width, cut->height = rays->height, cut->first = {0};
      for (std::size_t p = 0; p < whole.depth.size(); ++p) {
        const auto of = rays->of(p);
        for (std::size_t n = 0; n < of.size(); ++n) {
          RaySegment s = of[n];
          s.appearance = 0;
          if (n > 0) s.weight = weight;
          RaySegment tool;
          tool.appearance = RaySegment::kTool, tool.from_mm = tool.to_mm = s.from_mm;
          if (n > 0) cut->segments.push_back(tool);
          cut->segments.push_back(s);
        }
        cut->first.push_back(static_cast<std::uint32_t>(cut->segments.size()));
      }
      job.rays = {Which::All, 0};
      drawn(job, cut);
      double most = 0, dimmed = 0;
      for (std::size_t p = 0; p < whole.depth.size(); ++p) {
        if (!cut->meetsLens(p)) continue;
        const glm::dvec3 change = partsOf(job, *cut, p) - colourOf(whole, p);
        most = std::max(most, glm::length(change));
        dimmed = std::min(dimmed, change.x);
        EXPECT_LT(change.x, 1e-5);
      }
      if (weight == 1.0f) {
        EXPECT_LT(most, 1e-5);
      } else if (job.mode != ShellsMode::Lit) {
        EXPECT_LT(dimmed, -0.05);
      }
    }
  });
}

// Of the modes that caps do not add to. A mesh is no level set: where the field at a face has reached a level
// whose triangles the ray has missed, the cap shows it: in up to 3 of some 240 pixels here.
TEST(ShellParts, ALensThatChangesNothingIsNotSeen) {
  eachLook([](const PartsCase& c) {
    native::ShellsJob job = c.job();
    if (job.mode == ShellsMode::Sum) return;
    const Images whole = drawn(job);
    auto rays =
        cutRays(job.camera, job.kept, turnedBox(c.middle() + PatientVec(0.3, 0.2, 0.1), {4.1, 3.3, 5.2}));
    Images images;
    images.rays = rays;
    using Pass = RaysOfPass;
    const bool ordered = job.mode == ShellsMode::Lit;
    for (const Pass pass :
         {Pass{ordered ? Which::First : Which::All, 0}, Pass{Which::All, 1}, Pass{Which::Rest, 0}}) {
      if (!ordered && pass.which == Which::Rest) continue;
      job.rays = pass;
      ASSERT_TRUE(native::drawShells(job, images, {}).ok());
    }
    int off = 0;
    for (std::size_t p = 0; p < whole.depth.size(); ++p) {
      const glm::dvec3 got = rays->meetsLens(p) ? partsOf(job, *rays, p) : colourOf(images, p);
      off += glm::length(got - colourOf(whole, p)) > 0.25 / 255 ? 1 : 0;
    }
    EXPECT_LE(off, 3);
  });
}

}  // namespace
}  // namespace vernier::test
