// SPDX-License-Identifier: GPL-3.0-or-later
// projection.native and projection.exact: the rays of module native, with the tools that stand among them.
#include <algorithm>
#include <cmath>

#include "AngiographyTechniques.h"
#include "DumpNumber.h"
#include "vernier/native/Projection.h"
#include "vernier/plan/Volumetric.h"

namespace vernier::angiography {
namespace {

// Built-in costs of one thread, measured: of a ray, of a sample on it, and of a cell where all are walked.
constexpr double kRay_ns = 150, kFastSample_ns = 1.5, kGeneralSample_ns = 60;
constexpr double kExactRay_ns = 700, kExactCell_ns = 25;

struct ProjectionParams final : PassParams {
  std::shared_ptr<const Volume> volume;
  native::ProjectionJob job;  // without bounds and tools
  std::vector<PlacedSurface> tools;
  View view;
  std::string dump() const override;
};

bool isExtreme(ProjectionMode m) { return m == ProjectionMode::Max || m == ProjectionMode::Min; }

const char* nameOf(ProjectionMode mode) {
  constexpr const char* names[] = {"max", "min", "sum", "mean", "attenuation"};
  return names[static_cast<std::size_t>(mode)];
}

std::string ProjectionParams::dump() const {
  std::string s = nameOf(job.mode);
  s += job.camera.projection == Projection::Perspective ? ", perspective" : ", orthographic";
  s += job.exact ? ", cell by cell" : ", step " + number(job.step_mm) + " mm";
  if (job.interpolation == Interpolation::Nearest) s += ", nearest";
  s += ", window " + number(job.window.center) + "," + number(job.window.width);
  if (job.cue > 0) s += ", cue " + number(job.cue);
  if (job.mode == ProjectionMode::Sum || job.mode == ProjectionMode::Attenuation)
    s += ", gain " + number(job.gain_perMm) + "/mm";
  if (job.region.size() > 6) s += ", cut by " + std::to_string(job.region.size() - 6) + " planes";
  if (!tools.empty()) s += ", tools " + std::to_string(tools.size());
  return s;
}

double smallestSpacing_mm(const GridGeometry& g) {
  const glm::dvec3 s = g.spacing_mm();
  return std::min(s.x, std::min(s.y, s.z));
}

// What is the layer's own; the volume has been found.
Result<void> takeLayer(const ProjectionLayer& layer, const std::string& where, ProjectionParams& p) {
  native::ProjectionJob& job = p.job;
  job.volume = p.volume.get();
  job.mode = layer.mode, job.interpolation = layer.interpolation;
  job.invert = layer.invert != p.volume->info().inverted;
  const VoiWindow window = layer.window.value_or(wholeRange(*p.volume));
  if (!usableWindow(window))
    return makeError(ErrorCode::SceneInvalid, "The window needs a width above 0.", where + "/window");
  job.window = normalised(window);
  job.cue = layer.cue;
  job.gain_perMm = layer.gain_perMm.value_or(defaultGain_perMm(p.volume->grid()));
  return {};
}

Result<std::shared_ptr<ProjectionParams>> paramsOf(const Layer& any, std::size_t index,
                                                   const PlanContext& context) {
  const auto* layer = std::get_if<ProjectionLayer>(&any);
  if (!layer) return makeError(ErrorCode::SceneInvalid, "The layer is no projection.");
  const std::string where = "/layers/" + std::to_string(index);
  const auto found = context.sources.volumes.find(layer->source);
  if (found == context.sources.volumes.end() || !found->second)
    return makeError(ErrorCode::SceneInvalid, "The volume that the layer names is not loaded.",
                     where + "/source");
  auto p = std::make_shared<ProjectionParams>();
  p->volume = found->second;
  if (p->volume->isColour())
    return makeError(ErrorCode::NotBuiltYet,
                     "The volume is in colour, and projections are of single values; show it as slices.");
  const GridGeometry& grid = p->volume->grid();
  Result<std::vector<HalfSpace>> region = keptRegion(context.scene, grid);
  if (!region) return region.error();
  Result<CameraPicture> camera = cameraPicture(context.scene.camera, context.view, cameraBox(grid));
  if (!camera) return camera.error();
  if (Result<void> taken = takeLayer(*layer, where, *p); !taken) return taken.error();
  p->view = context.view;
  p->tools = context.tools;
  p->job.camera = *camera;
  p->job.region = std::move(*region);
  p->job.ramp = depthRamp(*camera, grid);
  p->job.step_mm = context.quality.step * smallestSpacing_mm(grid);
  p->job.background = context.scene.background;
  return p;
}

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

// Levels of 255 within which 99 % of the pixels lie: docs/error.md has the measured figures. Extrema miss
// peaks in proportion to the step, integrals what bends within it.
double predictedError(const ProjectionParams& p, double step) {
  if (p.job.exact) return 1e-3;
  return isExtreme(p.job.mode) ? 16 * step : 1.0 * step;
}

Result<std::vector<Pass>> passesFor(bool exact, const Layer& layer, std::size_t index,
                                    const PlanContext& context) {
  Result<std::shared_ptr<ProjectionParams>> params = paramsOf(layer, index, context);
  if (!params) return params.error();
  ProjectionParams& p = **params;
  if (exact) {
    if (std::string why = native::whyNotExact(p.job); !why.empty())
      return makeError(ErrorCode::NoTechnique, std::move(why));
    p.job.exact = true;
    p.job.step_mm = 0.9 * smallestSpacing_mm(p.volume->grid());  // of the search for a good start
  }
  Pass pass;
  pass.name = "projection " + std::to_string(index);
  pass.inputs = {"volume"};
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  if (!p.tools.empty()) pass.inputs.push_back("mesh");
  if (hasBounds(p)) pass.resources = {{"bounds of bricks", native::bytesOfBounds(p.volume->grid())}};
  pass.predicted_ms = predicted_ms(p, context);
  pass.predictedError = predictedError(p, context.quality.step);
  pass.params = *params;
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
  native::SurfaceHits hits;
  if (!p->tools.empty()) {
    Result<native::SurfaceHits> found = native::findSurfaces({p->tools, job.camera, glm::dvec3(0)}, stop);
    if (!found) return found.error();
    hits = std::move(*found);
    images.counters.triangles += hits.counters.triangles;
    job.tools = &hits;
  }
  if (p->view.wantValues)
    images.values.resize(static_cast<std::size_t>(p->view.width_px) *
                         static_cast<std::size_t>(p->view.height_px));
  return native::drawProjection(job, images, stop);
}

Technique projection(Host& host, const char* name, bool exact) {
  Technique t;
  t.name = name;
  t.kinds = {"projection"};
  t.engine = Engine::Native;
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
