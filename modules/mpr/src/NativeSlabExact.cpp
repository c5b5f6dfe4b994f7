// SPDX-License-Identifier: GPL-3.0-or-later
// mpr.exact: slabs without sampling error, by module native's walk through the cells.
#include <algorithm>

#include "ColourSlice.h"
#include "vernier/native/SlabExact.h"

namespace vernier::mpr {
namespace {

// Built-in cost of one cell of one thread, measured; the table of this machine wins.
constexpr double kExtreme_ns = 30, kMean_ns = 25;

double predicted_ms(const SliceParams& p, const PlanContext& context) {
  const auto known = context.costs.nsPerSample.find("mpr.exact");
  const double ns = known != context.costs.nsPerSample.end() ? known->second
                    : p.slab.mode == SlabMode::Mean          ? kMean_ns
                                                             : kExtreme_ns;
  native::SliceJob job = jobOf(p);
  if (p.volume->isColour()) job.volume = &p.volume->channel(0);
  const double cells = static_cast<double>(p.view.width_px) * p.view.height_px *
                       native::cellsPerSlabLine(job) * p.volume->info().channels;
  return cells * ns * 1e-6 / std::max(1, context.capabilities.threads);
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<const SliceParams>> params = sliceParams(layer, context, Colours::Drawn);
  if (!params) return params.error();
  native::SliceJob job = jobOf(**params);
  if ((*params)->volume->isColour()) job.volume = &(*params)->volume->channel(0);
  if (std::string why = native::whyNotExactSlab(job); !why.empty())
    return makeError(ErrorCode::NoTechnique, std::move(why));
  auto exact = std::make_shared<SliceParams>(**params);
  exact->slabSamples = 0;  // none: the plan says what is done
  Pass pass;
  pass.name = "slice " + std::to_string(index);
  pass.engine = Engine::Native;
  pass.technique = "mpr.exact";
  pass.inputs = {"volume"};
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  pass.predicted_ms = predicted_ms(*exact, context);
  pass.predictedError = roundingError(*exact);
  pass.notes = notesOf(std::get<SliceLayer>(layer), *exact);
  pass.params = std::move(exact);
  return std::vector<Pass>{std::move(pass)};
}

Result<void> execute(const Pass& pass, Images& images, std::stop_token stop) {
  const auto* p = dynamic_cast<const SliceParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no slice parameters.", "mpr.exact");
  fitImages(images, p->view);
  if (p->volume->isColour()) return drawColourSlice(*p, images, stop, native::drawSlabExact);
  return native::drawSlabExact(jobOf(*p), images, stop);
}

}  // namespace

Technique slabExactTechnique() {
  Technique t;
  t.name = "mpr.exact";
  t.kinds = {"slice"};
  t.engine = Engine::Native;
  t.passesFor = passesFor;
  t.execute = execute;
  return t;
}

}  // namespace vernier::mpr
