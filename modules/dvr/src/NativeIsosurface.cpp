// SPDX-License-Identifier: GPL-3.0-or-later
// iso.native: iso-surface layers by the rays of module native, with the tools that stand among them.
#include <cmath>

#include "DvrTechniques.h"
#include "NativeLook.h"
#include "vernier/native/Isosurface.h"

namespace vernier::dvr {
namespace {

// Built-in costs of one thread, measured: of a ray, and of a step's length of cells on it.
constexpr double kRay_ns = 150, kStep_ns = 1.5, kSampledStep_ns = 80;

struct IsoParams final : PassParams {
  NativeLook look;
  native::IsosurfaceJob job;  // without bricks and tools
  std::string dump() const override;
};

std::string IsoParams::dump() const {
  std::string s = "level " + number(job.level) + look.dumpCamera();
  s += native::findsExactly(job) ? ", cell by cell" : ", step " + number(job.step_mm) + " mm";
  return s + look.dumpLights() + look.dumpCuts();
}

Result<std::shared_ptr<IsoParams>> paramsOf(const Layer& any, std::size_t index, const PlanContext& context) {
  const auto* layer = std::get_if<IsosurfaceLayer>(&any);
  if (!layer) return makeError(ErrorCode::SceneInvalid, "The layer is no iso-surface.");
  const std::string where = "/layers/" + std::to_string(index);
  auto p = std::make_shared<IsoParams>();
  if (Result<void> r = p->look.take(layer->source, where, context); !r) return r.error();
  // Shading modes by name are drawn by the techniques that know combiners.
  if (!layer->combiner.empty())
    return makeError(ErrorCode::NoTechnique,
                     "Native rays know the lights of the scene, and a combiner was asked for.");
  if (p->look.volume->isColour())
    return makeError(ErrorCode::NoTechnique,
                     "A colour volume has no single values that could reach a level.");
  if (layer->level && !std::isfinite(*layer->level))
    return makeError(ErrorCode::SceneInvalid, "The level must be a finite number.", where + "/level");
  if (Result<void> ok = checkMaterial(layer->material, where + "/material"); !ok) return ok.error();
  native::IsosurfaceJob& job = p->job;
  job.volume = p->look.volume.get();
  job.camera = p->look.camera, job.region = p->look.region;
  job.level = layer->level.value_or(defaultIsoLevel(*job.volume));
  job.material = layer->material;
  job.lights = context.scene.lights, job.background = context.scene.background;
  job.step_mm = p->look.step_mm;
  return p;
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<IsoParams>> params = paramsOf(layer, index, context);
  if (!params) return params.error();
  const IsoParams& p = **params;
  const bool exact = native::findsExactly(p.job);
  Pass pass = p.look.pass("isosurface " + std::to_string(index));
  if (p.look.volume->grid().even())
    pass.resources = {{"bounds of bricks", native::bytesOfBounds(p.look.volume->grid())}};
  pass.predicted_ms = p.look.predicted_ms(kRay_ns, exact ? kStep_ns : kSampledStep_ns, context);
  pass.predictedError = exact ? 0.01 : 4 * context.quality.step;
  pass.params = *params;
  return std::vector<Pass>{std::move(pass)};
}

Result<std::shared_ptr<const native::VisibleBricks>> bricksOf(const IsoParams& p, DerivedCache& cache) {
  const auto bounds = p.look.bounds(cache);
  if (!bounds) return bounds.error();
  if (!*bounds) return std::shared_ptr<const native::VisibleBricks>();
  return cache.get<native::VisibleBricks>(
      {"native iso bricks", p.look.volume->revision(), exactNumber(p.job.level)},
      [&]() -> Result<DerivedCache::Made<native::VisibleBricks>> {
        auto made = native::bricksReaching(**bounds, p.job.level);
        return DerivedCache::Made<native::VisibleBricks>{made, native::bytesOf(*made)};
      });
}

Result<void> execute(const Pass& pass, Images& images, std::stop_token stop, DerivedCache& cache) {
  const auto* p = dynamic_cast<const IsoParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no iso-surface parameters.", pass.technique);
  native::IsosurfaceJob job = p->job;
  job.rays = pass.rays;
  const auto bricks = bricksOf(*p, cache);
  if (!bricks) return bricks.error();
  job.reaching = bricks->get();
  Result<native::SurfaceHits> hits = native::SurfaceHits{};
  if (job.rays.drawsPlainRays() && !p->look.tools.empty()) {
    hits = p->look.findTools(images, stop);
    if (!hits) return hits.error();
    job.tools = &*hits;
  }
  return native::drawIsosurface(job, images, stop);
}

}  // namespace

Technique nativeIsosurfaceTechnique(Host& host) {
  Technique t;
  t.name = "iso.native";
  t.kinds = {"isosurface"};
  t.engine = Engine::Native;
  t.drawsParts = true;
  t.passesFor = passesFor;
  t.execute = [&host](const Pass& p, Images& i, std::stop_token s) {
    return execute(p, i, s, host.derivedData());
  };
  return t;
}

}  // namespace vernier::dvr
