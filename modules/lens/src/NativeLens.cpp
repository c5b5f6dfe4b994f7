// SPDX-License-Identifier: GPL-3.0-or-later
// lens.native: rays cut at lenses and their parts joined, by module native.
#include <algorithm>

#include "LensParams.h"
#include "LensTechniques.h"
#include "vernier/lens/Shapes.h"
#include "vernier/native/LensRays.h"

namespace vernier::lens {
namespace {

// Built-in costs of one thread, measured: of a pixel that may meet a lens, for each face that is looked at,
// and of a part that is joined.
constexpr double kPixel_ns = 60, kTogether_ns = 15, kFace_ns = 1.5, kPart_ns = 25;

Result<void> execute(const Pass& pass, Images& images, std::stop_token stop) {
  if (const auto* join = dynamic_cast<const JoinParams*>(pass.params.get()))
    return native::joinParts(join->job, images, stop);
  const auto* cut = dynamic_cast<const CutParams*>(pass.params.get());
  if (!cut) return makeError(ErrorCode::Internal, "The pass has no lens parameters.", pass.technique);
  return cutLensRays(*cut, {}, images, stop);
}

}  // namespace

std::string CutParams::dump() const {
  std::string s = job.camera.projection == Projection::Perspective ? "perspective" : "orthographic";
  s += ", facets";
  for (std::size_t n : facets)
    s += " " + std::to_string(n) + (n > native::kAnalyticFacets && !onGl ? " (rasterised)" : "");
  if (!tools.empty() && !together) s += ", tools " + std::to_string(tools.size());
  return s + (together ? ", drawn in one walk" : "");
}

std::string JoinParams::dump() const {
  constexpr const char* names[] = {"ordered", "max", "min", "mean", "sum", "attenuation"};
  std::string s;
  for (Accumulator a : job.accumulators)
    s += (s.empty() ? "outside " : ", inside ") + std::string(names[static_cast<std::size_t>(a)]);
  return s;
}

namespace {

native::JoinJob joinJob(const Layer& behind, const PlanContext& context) {
  native::JoinJob job;
  for (const PlanContext::Appearance& a : context.appearances) job.accumulators.push_back(a.accumulator);
  const auto add = [&](const auto& layer) {
    job.overBackground.push_back(std::holds_alternative<ProjectionLayer>(layer));
    const auto* shells = std::get_if<ShellsLayer>(&layer);
    const bool max = shells && shells->mode == ShellsMode::Max;
    job.replaces.push_back(max && shells->surfaceBlend == SurfaceBlend::Replace);
    job.least.push_back(max ? shells->beta0 * shells->phi0 *
                                  glm::dvec3(shells->colour.r, shells->colour.g, shells->colour.b)
                            : glm::dvec3(0));
  };
  add(behind);
  for (const PlacedLens& l : context.lenses) add(std::get<LensLayer>(context.scene.layers[l.layer]).inner);
  const Rgb& b = context.scene.background;
  job.background = {b.r, b.g, b.b};
  return job;
}

}  // namespace

Result<std::vector<Pass>> lensPasses(const PlanContext& context) {
  if (context.lenses.empty() || context.appearances.size() != context.lenses.size() + 1)
    return makeError(ErrorCode::SceneInvalid, "The lens has nothing to look into.");
  const auto behind =
      std::find_if(context.scene.layers.begin(), context.scene.layers.end(), looksThroughVolume);
  if (behind == context.scene.layers.end())
    return makeError(ErrorCode::SceneInvalid, "The lens has no volume to look into.");
  const auto volume = context.sources.volumes.find(*volumeOf(*behind));
  if (volume == context.sources.volumes.end() || !volume->second)
    return makeError(ErrorCode::SceneInvalid, "The volume that the layer names is not loaded.");
  const GridGeometry& grid = volume->second->grid();
  auto cut = std::make_shared<CutParams>();
  Result<std::vector<HalfSpace>> kept = keptRegion(context.scene, grid);
  if (!kept) return kept.error();
  Result<CameraPicture> camera = cameraPicture(context.scene.camera, context.view, cameraBox(grid));
  if (!camera) return camera.error();
  cut->job.camera = *camera, cut->job.region = *std::move(kept), cut->tools = context.tools;
  double faces = 0;
  for (const PlacedLens& l : context.lenses) {
    cut->job.lenses.push_back(l.region);
    cut->facets.push_back(l.region->planes.size());
    faces += static_cast<double>(std::min(l.region->planes.size(), native::kAnalyticFacets));
  }
  cut->together = context.together;

  const double pixels = static_cast<double>(context.view.width_px) * context.view.height_px;
  const double threads = std::max(1, context.capabilities.threads);
  const double parts = 0.25 * pixels * static_cast<double>(1 + 2 * context.lenses.size());
  std::vector<Pass> passes(context.together ? 1 : 2);
  passes[0].name = context.lenses.size() == 1
                       ? "rays cut at a lens"
                       : "rays cut at " + std::to_string(context.lenses.size()) + " lenses";
  passes[0].outputs = {"parts of rays"};
  const double bytes = context.together
                           ? 0.25 * pixels * static_cast<double>(sizeof(RaySpan) * context.lenses.size())
                           : parts * sizeof(RaySegment);
  passes[0].resources = {{"parts of rays", static_cast<std::uint64_t>(bytes)}};
  passes[0].predicted_ms =
      0.25 * pixels * ((context.together ? kTogether_ns : kPixel_ns) + faces * kFace_ns) * 1e-6 / threads;
  passes[0].params = std::move(cut);
  if (context.together) return passes;
  auto join = std::make_shared<JoinParams>();
  join->job = joinJob(*behind, context);
  passes[1].name = "parts joined";
  passes[1].inputs = {"parts of rays"};
  passes[1].outputs = {"colour", "depth"};
  passes[1].predicted_ms = parts * kPart_ns * 1e-6 / threads;
  passes[1].params = std::move(join);
  return passes;
}

Result<void> cutLensRays(const CutParams& cut, const std::vector<native::LensSpans>& known, Images& images,
                         std::stop_token stop) {
  native::LensRaysJob job = cut.job;
  if (!known.empty()) job.known = &known;
  if (cut.together) return native::markLenses(job, images, stop);
  Result<native::SurfaceHits> hits = native::SurfaceHits{};
  if (!cut.tools.empty()) {
    hits = native::findSurfaces({cut.tools, job.camera, glm::dvec3(0)}, stop);
    if (!hits) return hits.error();
    images.counters.triangles += hits->counters.triangles;
    job.tools = &*hits;
  }
  return native::cutRays(job, images, stop);
}

Technique nativeLensTechnique(Host& host) {
  Technique t;
  t.name = "lens.native";
  t.kinds = {"lens"};
  t.engine = Engine::Native;
  t.region = [&host](const LensLayer& l, const Sources& s) { return convexRegion(l, s, host.derivedData()); };
  t.passesFor = [](const Layer&, std::size_t, const PlanContext& c) { return lensPasses(c); };
  t.execute = execute;
  return t;
}

}  // namespace vernier::lens
