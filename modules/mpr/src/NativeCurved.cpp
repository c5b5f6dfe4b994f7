// SPDX-License-Identifier: GPL-3.0-or-later
// mpr.curved: curved planar reformats by module native.
#include <algorithm>

#include "NativeJob.h"
#include "SamplingError.h"
#include "vernier/native/Curved.h"

namespace vernier::mpr {
namespace {

native::CurvedJob curvedJobOf(const CurvedParams& p) {
  native::CurvedJob job;
  job.volume = p.volume.get();
  job.picture = &p.picture;
  job.width_px = p.view.width_px;
  job.height_px = p.view.height_px;
  job.interpolation = p.interpolation;
  job.slab = p.slab;
  job.slabSamples = p.slabSamples;
  job.window = p.window;
  job.invert = p.invert;
  job.background = p.background;
  return job;
}

double predicted_ms(const CurvedParams& p, const PlanContext& context) {
  const auto& columns = p.picture.columns;
  const auto shown =
      std::find_if(columns.begin(), columns.end(), [](const CurvedColumn& c) { return c.shown; });
  if (shown == columns.end()) return 0;
  const auto known = context.costs.nsPerSample.find("mpr.curved");
  const bool fast = native::drawsFast(native::columnJob(curvedJobOf(p), *shown));
  const double ns =
      known != context.costs.nsPerSample.end() ? known->second : builtInCost_ns(p.interpolation, fast);
  const double rows = p.picture.endRow(p.view.height_px) - p.picture.firstRow(p.view.height_px);
  return rows * p.view.width_px * p.slabSamples * ns * 1e-6 / std::max(1, context.capabilities.threads);
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<const CurvedParams>> params = curvedParams(layer, context);
  if (!params) return params.error();
  Pass pass;
  pass.name = "curved " + std::to_string(index);
  pass.engine = Engine::Native;
  pass.technique = "mpr.curved";
  pass.inputs = {"volume"};
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  pass.predicted_ms = predicted_ms(**params, context);
  pass.predictedError = roundingError(**params) + samplingError(**params, context.quality.step);
  pass.notes = (*params)->picture.notes;
  pass.params = *params;
  return std::vector<Pass>{std::move(pass)};
}

Result<void> execute(const Pass& pass, Images& images, std::stop_token stop) {
  const auto* p = dynamic_cast<const CurvedParams*>(pass.params.get());
  if (!p)
    return makeError(ErrorCode::Internal, "The pass has no parameters of a curved reformat.", "mpr.curved");
  fitImages(images, p->view);
  return native::drawCurved(curvedJobOf(*p), images, stop);
}

}  // namespace

Technique curvedTechnique() {
  Technique t;
  t.name = "mpr.curved";
  t.kinds = {"curved"};
  t.engine = Engine::Native;
  t.passesFor = passesFor;
  t.execute = execute;
  return t;
}

}  // namespace vernier::mpr
