// SPDX-License-Identifier: GPL-3.0-or-later
// projection.native and projection.exact: the rays of module native, with the tools that stand among them.
#include <algorithm>
#include <optional>
#include <span>

#include "AngiographyTechniques.h"
#include "ProjectionParams.h"

namespace vernier::angiography {
namespace {

// Built-in costs of one thread, measured: of a ray, of a sample on it, and of a cell where all are walked.
constexpr double kRay_ns = 150, kFastSample_ns = 1.5, kGeneralSample_ns = 60;
constexpr double kExactRay_ns = 1600, kExactCell_ns = 25;

// Bounds are made of even grids only.
bool hasBounds(const ProjectionParams& p) { return p.volume->grid().even(); }

double predicted_ms(const ProjectionParams& p, const PlanContext& context) {
  const double rays = static_cast<double>(p.view.width_px) * static_cast<double>(p.view.height_px);
  const double length_mm = 0.5 * cameraBox(p.volume->grid()).diagonal_mm;
  double ns = 0;
  if (p.job.exact) {
    const bool skips = isExtreme(p.job.mode);
    ns = kExactRay_ns + (skips ? 0 : 2 * kExactCell_ns * length_mm / smallestSpacing_mm(p.volume->grid()));
  } else {
    const bool fast = hasBounds(p) && p.job.interpolation == Interpolation::Linear;
    const auto known = context.costs.nsPerSample.find("projection.native");
    const double sample = known != context.costs.nsPerSample.end()
                              ? known->second
                              : (fast ? kFastSample_ns : kGeneralSample_ns);
    ns = kRay_ns + sample * length_mm / p.job.step_mm;
  }
  return rays * ns * 1e-6 / std::max(1, context.capabilities.threads);
}

Result<std::vector<Pass>> passesFor(bool exact, const Layer& layer, std::size_t index,
                                    const PlanContext& context) {
  Result<std::shared_ptr<ProjectionParams>> params = projectionParams(layer, index, context);
  if (!params) return params.error();
  ProjectionParams& p = **params;
  if (exact) {
    if (std::string why = native::whyNotExact(p.job); !why.empty())
      return makeError(ErrorCode::NoTechnique, std::move(why));
    p.job.exact = true;
    p.job.step_mm = 0.9 * smallestSpacing_mm(p.volume->grid());  // of the search for a good start
  }
  Result<Pass> made = projectionPass(*params, index, context);
  if (!made) return made.error();
  Pass pass = *std::move(made);
  if (hasBounds(p)) pass.resources = {{"bounds of bricks", native::bytesOfBounds(p.volume->grid())}};
  pass.predicted_ms = predicted_ms(p, context);
  return std::vector<Pass>{std::move(pass)};
}

Result<std::shared_ptr<const native::ProjectionBounds>> boundsOf(const ProjectionParams& p,
                                                                 DerivedCache& cache) {
  if (!hasBounds(p)) return std::shared_ptr<const native::ProjectionBounds>();
  return cache.get<native::ProjectionBounds>(
      {"projection bounds", p.volume->revision(), ""},
      [&]() -> Result<DerivedCache::Made<native::ProjectionBounds>> {
        Result<std::shared_ptr<const native::ProjectionBounds>> made = native::projectionBounds(*p.volume);
        if (!made) return made.error();
        return DerivedCache::Made<native::ProjectionBounds>{*made, native::bytesOfBounds(p.volume->grid())};
      });
}

Result<void> execute(const Pass& pass, Images& images, std::stop_token stop, DerivedCache& cache) {
  const auto* p = dynamic_cast<const ProjectionParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no projection parameters.", pass.technique);
  const Result<std::shared_ptr<const native::ProjectionBounds>> bounds = boundsOf(*p, cache);
  if (!bounds) return bounds.error();
  native::ProjectionJob job = p->job;
  job.bounds = bounds->get();
  if (pass.rays.which == RaysOfPass::Which::Together)
    images.rays.reset();
  else
    job.rays = pass.rays;
  native::SurfaceHits tools;
  if (!p->tools.empty() && pass.rays.drawsPlainRays()) {
    Result<native::SurfaceHits> found = toolsOf(*p, images, stop);
    if (!found) return found.error();
    tools = *std::move(found);
    job.tools = &tools;
  }
  if (p->view.wantValues)
    images.values.resize(static_cast<std::size_t>(p->view.width_px) *
                         static_cast<std::size_t>(p->view.height_px));
  return native::drawProjection(job, images, stop);
}

bool looksAlike(const native::ProjectionJob& a, const native::ProjectionJob& b) {
  return a.volume == b.volume && a.mode == b.mode && a.interpolation == b.interpolation &&
         a.window == b.window && a.invert == b.invert && a.cue == b.cue && a.gain_perMm == b.gain_perMm &&
         a.step_mm == b.step_mm && a.exact == b.exact;
}

// Lenses that show what stands around them: the plain picture. A mean is of the whole ray then.
std::optional<Pass> together(std::span<const Pass* const> passes) {
  const auto paramsOf = [](const Pass* p) {
    return p ? dynamic_cast<const ProjectionParams*>(p->params.get()) : nullptr;
  };
  const ProjectionParams* const outside = paramsOf(passes.front());
  for (const Pass* pass : passes.subspan(1)) {
    const ProjectionParams* const inside = paramsOf(pass);
    if (!outside || !inside || !looksAlike(outside->job, inside->job)) return std::nullopt;
  }
  return *passes.front();
}

Technique projection(Host& host, const char* name, bool exact) {
  Technique t;
  t.name = name;
  t.kinds = {"projection"};
  t.engine = Engine::Native;
  t.drawsParts = true;
  t.together = together;
  t.passesFor = [exact](const Layer& l, std::size_t i, const PlanContext& c) {
    return passesFor(exact, l, i, c);
  };
  t.execute = [&host](const Pass& p, Images& i, std::stop_token s) {
    return execute(p, i, s, host.derivedData());
  };
  return t;
}

}  // namespace

Technique sampledProjectionTechnique(Host& host) { return projection(host, "projection.native", false); }
Technique exactProjectionTechnique(Host& host) { return projection(host, "projection.exact", true); }

}  // namespace vernier::angiography
