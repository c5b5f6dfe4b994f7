// SPDX-License-Identifier: GPL-3.0-or-later
#include "ProjectionParams.h"

#include <algorithm>
#include <cmath>

#include "DumpNumber.h"
#include "vernier/plan/Volumetric.h"

namespace vernier::angiography {
namespace {

const char* nameOf(ProjectionMode mode) {
  constexpr const char* names[] = {"max", "min", "sum", "mean", "attenuation"};
  return names[static_cast<std::size_t>(mode)];
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
  if (!(layer.cue >= 0 && layer.cue <= 1))
    return makeError(ErrorCode::SceneInvalid, "The depth cue lies between 0 and 1.", where + "/cue");
  job.cue = layer.cue;
  job.gain_perMm = layer.gain_perMm.value_or(defaultGain_perMm(p.volume->grid()));
  if (!(job.gain_perMm > 0) || !std::isfinite(job.gain_perMm))
    return makeError(ErrorCode::SceneInvalid, "The gain must be a number above 0.", where + "/gain_per_mm");
  return {};
}

}  // namespace

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

Result<std::shared_ptr<ProjectionParams>> projectionParams(const Layer& any, std::size_t index,
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

double predictedError(const ProjectionParams& p, double step) {
  if (p.job.exact) return 1e-3;
  return isExtreme(p.job.mode) ? 16 * step : 1.0 * step;
}

Result<Accumulator> accumulatorOf(const ProjectionParams& p, const PlanContext& context) {
  const bool inverted = p.job.invert;
  if (!context.lenses.empty() && inverted && (!isExtreme(p.job.mode) || !context.tools.empty()))
    return makeError(ErrorCode::NoTechnique,
                     std::string("An inverted projection of mode ") + nameOf(p.job.mode) +
                         (isExtreme(p.job.mode) ? " with tools" : "") + " cannot be cut at a lens.");
  switch (p.job.mode) {
    case ProjectionMode::Max:
      return inverted ? Accumulator::Min : Accumulator::Max;
    case ProjectionMode::Min:
      return inverted ? Accumulator::Max : Accumulator::Min;
    case ProjectionMode::Mean:
      return Accumulator::Mean;
    case ProjectionMode::Sum:
      return Accumulator::Sum;
    case ProjectionMode::Attenuation:
      break;
  }
  return Accumulator::Attenuation;
}

Result<Pass> projectionPass(std::shared_ptr<const ProjectionParams> params, std::size_t index,
                            const PlanContext& context) {
  const Result<Accumulator> accumulator = accumulatorOf(*params, context);
  if (!accumulator) return accumulator.error();
  Pass pass;
  pass.accumulator = *accumulator;
  pass.name = "projection " + std::to_string(index);
  pass.inputs = {"volume"};
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  if (!params->tools.empty()) pass.inputs.push_back("mesh");
  pass.predictedError = predictedError(*params, context.quality.step);
  pass.params = std::move(params);
  return pass;
}

Result<native::SurfaceHits> toolsOf(const ProjectionParams& p, Images& images, std::stop_token stop) {
  if (p.tools.empty()) return native::SurfaceHits{};
  Result<native::SurfaceHits> found = native::findSurfaces({p.tools, p.job.camera, glm::dvec3(0)}, stop);
  if (found) images.counters.triangles += found->counters.triangles;
  return found;
}

}  // namespace vernier::angiography
