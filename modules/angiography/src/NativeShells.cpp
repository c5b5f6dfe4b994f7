// SPDX-License-Identifier: GPL-3.0-or-later
// shells.native: all shells and tools of a picture by the native rasteriser.
#include <algorithm>

#include "AngiographyTechniques.h"
#include "ShellParams.h"

namespace vernier::angiography {
namespace {

// Built-in costs of one thread, measured; per triangle of the shells and per pixel of the picture.
constexpr double kTriangle_ns = 30.0, kPixel_ns = 30.0;

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context,
                                    ShellStore& store) {
  const Result<std::shared_ptr<const ShellParams>> params = shellParams(layer, index, context, store);
  if (!params) return params.error();
  Pass pass = shellPass(*params, index);
  const std::uint64_t triangles = (*params)->triangles;
  pass.resources.push_back({"vertices in pixels", 12 * triangles});
  const double pixels = static_cast<double>(context.view.width_px) * context.view.height_px;
  pass.predicted_ms = (static_cast<double>(triangles) * kTriangle_ns + pixels * kPixel_ns) * 1e-6 /
                      std::max(1, context.capabilities.threads);
  return std::vector<Pass>{std::move(pass)};
}

Result<void> execute(const Pass& pass, Images& images, std::stop_token stop, ShellStore& store) {
  const auto* p = dynamic_cast<const ShellParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no parameters of shells.", "shells.native");
  Result<native::ShellsJob> job = withMeshes(*p, store, stop);
  if (!job) return job.error();
  job->rays = pass.rays;
  return native::drawShells(*job, images, stop);
}

}  // namespace

Technique nativeShellsTechnique(std::shared_ptr<ShellStore> store) {
  Technique t;
  t.name = "shells.native";
  t.kinds = {"shells"};
  t.engine = Engine::Native;
  t.drawsParts = true;
  t.passesFor = [store](const Layer& layer, std::size_t index, const PlanContext& context) {
    return passesFor(layer, index, context, *store);
  };
  t.execute = [store](const Pass& pass, Images& images, std::stop_token stop) {
    return execute(pass, images, stop, *store);
  };
  return t;
}

}  // namespace vernier::angiography
