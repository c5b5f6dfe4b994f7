// SPDX-License-Identifier: GPL-3.0-or-later
// mpr.native: slices and slabs by the SIMD kernels of module native. No GL, no texture, one pass.
#include <algorithm>
#include <cmath>

#include "ColourSlice.h"
#include "SamplingError.h"

namespace vernier::mpr {
namespace {

// Built-in cost of one sample of one thread, measured; the table of this machine wins.
constexpr double kFast_ns = 2.5, kGeneral_ns = 40.0;
constexpr double kFastCubic_ns = 20.0, kGeneralCubic_ns = 240.0;

double predicted_ms(const SliceParams& p, const PlanContext& context) {
  const auto known = context.costs.nsPerSample.find("mpr.native");
  native::SliceJob job = jobOf(p);
  if (p.volume->isColour()) job.volume = &p.volume->channel(0);
  const double ns = known != context.costs.nsPerSample.end()
                        ? known->second
                        : builtInCost_ns(p.interpolation, native::drawsFast(job));
  const double samples =
      static_cast<double>(p.view.width_px) * p.view.height_px * p.slabSamples * p.volume->info().channels;
  return samples * ns * 1e-6 / std::max(1, context.capabilities.threads);
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<const SliceParams>> params = sliceParams(layer, context, Colours::Drawn);
  if (!params) return params.error();
  Pass pass;
  pass.name = "slice " + std::to_string(index);
  pass.engine = Engine::Native;
  pass.technique = "mpr.native";
  pass.inputs = {"volume"};
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  pass.predicted_ms = predicted_ms(**params, context);
  pass.predictedError = roundingError(**params) + samplingError(**params, context.quality.step);
  pass.notes = notesOf(std::get<SliceLayer>(layer), **params);
  Result<std::vector<SliceInside>> lenses = lensesOnSlice(**params, context);
  if (!lenses) return lenses.error();
  if (lenses->empty()) {
    pass.params = *params;
    return std::vector<Pass>{std::move(pass)};
  }
  auto lensed = std::make_shared<SliceParams>(**params);
  lensed->lenses = *std::move(lenses);
  pass.predicted_ms *= 1 + static_cast<double>(lensed->lenses.size());
  for (const SliceInside& l : lensed->lenses) {
    SliceParams inner = *lensed;
    inner.window = l.window, inner.interpolation = l.interpolation;
    if (!l.cutOut)
      pass.predictedError =
          std::max(pass.predictedError, roundingError(inner) + samplingError(inner, context.quality.step));
  }
  pass.params = std::move(lensed);
  return std::vector<Pass>{std::move(pass)};
}

Result<void> execute(const Pass& pass, Images& images, std::stop_token stop) {
  const auto* p = dynamic_cast<const SliceParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no slice parameters.", "mpr.native");
  fitImages(images, p->view);
  if (p->volume->isColour()) return drawColourSlice(*p, images, stop, native::drawSlice);
  Result<void> drawn = native::drawSlice(jobOf(*p), images, stop);
  return drawn && !p->lenses.empty() ? drawLenses(*p, images, stop) : drawn;
}

}  // namespace

double builtInCost_ns(Interpolation interpolation, bool fast) {
  if (interpolation == Interpolation::Cubic) return fast ? kFastCubic_ns : kGeneralCubic_ns;
  return fast ? kFast_ns : kGeneral_ns;
}

// The kernels' bound: 1e-6 of the volume's range (RENDERING 3, "Slices").
double roundingError(const SampledParams& p) {
  const auto range = p.volume->modalityRange();
  const double contrast = range ? (range->max - range->min) / p.window.width : 1.0;
  return std::min(255.0, 255.0 * 1e-6 * contrast);
}

Technique nativeSliceTechnique() {
  Technique t;
  t.name = "mpr.native";
  t.kinds = {"slice"};
  t.engine = Engine::Native;
  t.drawsLenses = true;
  t.passesFor = passesFor;
  t.execute = execute;
  return t;
}

}  // namespace vernier::mpr
