// SPDX-License-Identifier: GPL-3.0-or-later
// dvr.native: volume layers by the rays of module native, with the tools that stand among them.
#include <algorithm>
#include <cmath>

#include "ChooseClassification.h"
#include "DvrTechniques.h"
#include "NativeLook.h"
#include "SamplingError.h"
#include "vernier/plan/SceneJson.h"

namespace vernier::dvr {
namespace {

// Built-in costs of one thread, measured: of a ray through the kept region, of a step on it, of one that is
// lit; and of the double path.
constexpr double kRay_ns = 20, kStep_ns = 0.25, kLitStep_ns = 0.45, kGeneralStep_ns = 250,
                 kGeneralLitStep_ns = 900;

struct VolumeParams final : PassParams {
  NativeLook look;
  native::VolumeRenderJob job;  // without tables, bricks and tools
  TransferFunction function;    // of grey volumes
  // Drawn together with it: what lenses show, null for nothing.
  std::vector<std::shared_ptr<const VolumeParams>> insides;
  std::string dump() const override;
};

std::string VolumeParams::dump() const {
  constexpr const char* modes[] = {"blend", "max", "min"};
  constexpr const char* classifications[] = {"post", "pre", "pre-integrated"};
  constexpr const char* models[] = {"", ", lit, one colour", ", lit, colour per voxel"};
  const bool blend = job.mode == VolumeMode::Blend;
  std::string s = modes[static_cast<std::size_t>(job.mode)];
  s += look.dumpCamera();
  s += job.exact && !blend ? ", cell by cell" : ", step " + number(job.step_mm) + " mm";
  if (look.volume->isColour())
    s += ", RGBA";
  else if (blend)
    s += std::string(", ") + classifications[static_cast<std::size_t>(job.classification)];
  if (job.opacity == OpacityRule::Linear) s += ", linear opacity";
  if (job.interpolation == Interpolation::Nearest) s += ", nearest";
  s += models[static_cast<std::size_t>(job.shading)];
  if (job.shading != ShadingModel::None) s += look.dumpLights();
  s += look.dumpCuts();
  if (!insides.empty()) s += ", with lenses " + std::to_string(insides.size());
  return s;
}

Error cannot(std::string why) { return makeError(ErrorCode::NoTechnique, std::move(why)); }

Result<void> takeColour(const VolumeLayer& layer, const std::string& where, VolumeParams& p) {
  if (layer.transfer || !layer.preset.empty())
    return makeError(ErrorCode::SceneInvalid,
                     "A colour volume has its own colours and takes no transfer function.",
                     where + (layer.transfer ? "/transfer" : "/preset"));
  if (layer.shading != ShadingModel::None)
    return cannot("A colour volume has no single values whose gradient could be lit.");
  if (layer.classification && *layer.classification != Classification::Post)
    return cannot("A colour volume has no values that could be classified.");
  for (std::size_t c = 0; c < 4; ++c)
    if (!(layer.gains[c] >= 0) || !std::isfinite(layer.gains[c]))
      return makeError(ErrorCode::SceneInvalid, "A gain is a number not below 0.",
                       where + "/gains/" + std::to_string(c));
  p.job.gains = layer.gains;
  return {};
}

Result<void> takeGrey(const VolumeLayer& layer, const std::string& where, VolumeParams& p) {
  const Volume& volume = *p.look.volume;
  if (layer.transfer) {
    p.function = *layer.transfer;
    if (Result<void> ok = checkTransferFunction(p.function); !ok)
      return makeError(ok.error().code, ok.error().sentence, where + "/transfer" + ok.error().where);
  } else {
    Result<TransferFunction> f =
        transferPreset(layer.preset.empty() ? defaultTransferPreset(volume) : layer.preset, volume);
    if (!f) return f.error();
    p.function = *std::move(f);
  }
  p.job.function = &p.function;
  if (layer.mode != VolumeMode::Blend) {
    if (layer.shading != ShadingModel::None)
      return cannot("A greatest or least value has no face that could be lit.");
    return {};
  }
  if (layer.classification == Classification::PreIntegrated && layer.opacity == OpacityRule::Linear)
    return cannot(
        "Pre-integrated tables hold exact opacities; the linear rule is for the other classifications.");
  if (layer.classification)
    p.job.classification = *layer.classification;
  else if (layer.opacity == OpacityRule::Exact && layer.interpolation == Interpolation::Linear)
    p.job.classification = chooseClassification(volume, p.function, p.job.step_mm);
  p.job.shading = layer.shading;
  p.job.material = layer.material;
  return checkMaterial(layer.material, where + "/material");
}

Result<std::shared_ptr<VolumeParams>> paramsOf(const Layer& any, std::size_t index,
                                               const PlanContext& context) {
  const auto* layer = std::get_if<VolumeLayer>(&any);
  if (!layer) return makeError(ErrorCode::SceneInvalid, "The layer is no volume.");
  const std::string where = "/layers/" + std::to_string(index);
  auto p = std::make_shared<VolumeParams>();
  if (Result<void> r = p->look.take(layer->source, where, context); !r) return r.error();
  if (!context.appearances.empty() && layer->mode != VolumeMode::Blend)
    return cannot("With lenses a greatest or least value is drawn by a projection; make it one.");
  // Shading modes by name are drawn by the techniques that know combiners.
  if (!layer->combiner.empty())
    return cannot("Native rays know the lights of the scene, and a combiner was asked for.");
  if (layer->interpolation == Interpolation::Cubic)
    return cannot("Volumes are interpolated nearest or linear.");
  native::VolumeRenderJob& job = p->job;
  job.volume = p->look.volume.get();
  job.camera = p->look.camera, job.region = p->look.region;
  job.lights = context.scene.lights, job.background = context.scene.background;
  job.mode = layer->mode, job.opacity = layer->opacity, job.interpolation = layer->interpolation;
  job.step_mm = p->look.step_mm;
  const bool reference = context.quality.level == QualityLevel::Reference;
  job.exact = context.quality.level != QualityLevel::Draft;
  job.leastLight = reference ? native::kReferenceLeastLight : native::kReviewLeastLight;
  const bool colour = job.volume->isColour();
  if (Result<void> r = colour ? takeColour(*layer, where, *p) : takeGrey(*layer, where, *p); !r)
    return r.error();
  return p;
}

bool hasBounds(const VolumeParams& p) { return p.look.volume->grid().even() && !p.look.volume->isColour(); }

double predicted_ms(const VolumeParams& p, const PlanContext& context) {
  const native::VolumeRenderJob& job = p.job;
  const bool lit = job.shading != ShadingModel::None;
  const bool fast = hasBounds(p) && job.interpolation == Interpolation::Linear &&
                    (job.mode != VolumeMode::Blend || job.classification != Classification::Pre);
  double step_ns = fast ? (lit ? kLitStep_ns : kStep_ns) : (lit ? kGeneralLitStep_ns : kGeneralStep_ns);
  if (const auto known = context.costs.nsPerSample.find("dvr.native");
      known != context.costs.nsPerSample.end())
    step_ns = known->second;
  return p.look.predicted_ms(kRay_ns, step_ns, context);
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<VolumeParams>> params = paramsOf(layer, index, context);
  if (!params) return params.error();
  const VolumeParams& p = **params;
  Pass pass = p.look.pass("volume " + std::to_string(index));
  if (hasBounds(p)) pass.resources = {{"bounds of bricks", native::bytesOfBounds(p.look.volume->grid())}};
  pass.predicted_ms = predicted_ms(p, context);
  pass.predictedError =
      samplingError(p.job.mode, p.job.shading, p.job.opacity, p.job.exact, context.quality.step);
  pass.params = *params;
  return std::vector<Pass>{std::move(pass)};
}

// Whether both differ in their transfer functions alone.
bool drawnAlike(const native::VolumeRenderJob& a, const native::VolumeRenderJob& b) {
  const bool lit = a.shading != ShadingModel::None;
  return a.volume == b.volume && a.mode == b.mode && a.classification == b.classification &&
         a.opacity == b.opacity && a.interpolation == b.interpolation && a.shading == b.shading &&
         (!lit || a.material == b.material) && a.step_mm == b.step_mm && a.leastLight == b.leastLight;
}

std::optional<Pass> together(std::span<const Pass* const> passes) {
  if (passes.size() > native::kMostInsides + 1) return std::nullopt;
  const auto paramsOfPass = [](const Pass* p) {
    return p ? std::dynamic_pointer_cast<const VolumeParams>(p->params) : nullptr;
  };
  const std::shared_ptr<const VolumeParams> outside = paramsOfPass(passes.front());
  if (!outside || outside->look.volume->isColour() || outside->job.mode != VolumeMode::Blend)
    return std::nullopt;
  auto all = std::make_shared<VolumeParams>(*outside);
  all->job.function = &all->function;
  Pass out = *passes.front();
  for (const Pass* pass : passes.subspan(1)) {
    const std::shared_ptr<const VolumeParams> inside = paramsOfPass(pass);
    if (pass && (!inside || !drawnAlike(outside->job, inside->job))) return std::nullopt;
    if (pass) out.predictedError = std::max(out.predictedError, pass->predictedError);
    all->insides.push_back(inside);
  }
  out.params = std::move(all);
  return out;
}

// What is made of a transfer function for a volume and a step.
struct Tables {
  std::optional<TransferTable> post;
  std::optional<PreIntegratedTable> preIntegrated;
  std::shared_ptr<const native::VisibleBricks> visible;
};

Result<DerivedCache::Made<Tables>> makeTables(const VolumeParams& p, const native::ProjectionBounds* bounds) {
  const native::VolumeRenderJob& job = p.job;
  const Volume::Range values = p.look.volume->modalityRange().value_or(Volume::Range{0, 1});
  Volume::Range range = transferTableRange(p.function, values);
  auto out = std::make_shared<Tables>();
  std::uint64_t bytes = 0;
  int entries = kTransferEntries;
  if (job.classification == Classification::PreIntegrated) {
    range = preIntegratedRange(p.function, values);
    Result<PreIntegratedTable> t = makePreIntegratedTable(p.function, range, job.step_mm);
    if (!t) return t.error();
    entries = t->size, bytes += sizeof(float) * t->rgba.size();
    out->preIntegrated = *std::move(t);
  } else {
    Result<TransferTable> t =
        makeTransferTable(p.function, range, job.step_mm, job.opacity == OpacityRule::Linear);
    if (!t) return t.error();
    bytes += sizeof(float) * t->rgba.size();
    out->post = *std::move(t);
  }
  if (bounds) {
    out->visible = native::visibleBricks(*bounds, p.function, range, entries);
    bytes += native::bytesOf(*out->visible);
  }
  return DerivedCache::Made<Tables>{out, bytes};
}

Result<std::shared_ptr<const Tables>> tablesOf(const VolumeParams& p, const native::ProjectionBounds* bounds,
                                               DerivedCache& cache) {
  const std::string what = exactNumber(p.job.step_mm) + " " +
                           std::to_string(static_cast<int>(p.job.opacity)) +
                           std::to_string(static_cast<int>(p.job.classification)) + writeTransfer(p.function);
  return cache.get<Tables>({"native transfer tables", p.look.volume->revision(), what},
                           [&] { return makeTables(p, bounds); });
}

Result<void> execute(const Pass& pass, Images& images, std::stop_token stop, DerivedCache& cache) {
  const auto* p = dynamic_cast<const VolumeParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no volume parameters.", pass.technique);
  native::VolumeRenderJob job = p->job;
  job.rays = pass.rays;
  const auto bounds = p->look.bounds(cache);
  if (!bounds) return bounds.error();
  job.bounds = bounds->get();
  std::shared_ptr<const Tables> tables;
  if (!p->look.volume->isColour() && job.mode == VolumeMode::Blend) {
    Result<std::shared_ptr<const Tables>> made = tablesOf(*p, job.bounds, cache);
    if (!made) return made.error();
    tables = *std::move(made);
    job.table = tables->post ? &*tables->post : nullptr;
    job.preIntegrated = tables->preIntegrated ? &*tables->preIntegrated : nullptr;
    job.visible = tables->visible.get();
  }
  std::vector<std::shared_ptr<const Tables>> kept;
  for (const auto& inside : p->insides) {
    job.insides.emplace_back();
    if (!inside) continue;
    Result<std::shared_ptr<const Tables>> made = tablesOf(*inside, job.bounds, cache);
    if (!made) return made.error();
    const Tables& t = **made;
    job.insides.back() = {t.visible.get(), &inside->function, t.post ? &*t.post : nullptr,
                          t.preIntegrated ? &*t.preIntegrated : nullptr};
    kept.push_back(*std::move(made));
  }
  Result<native::SurfaceHits> hits = native::SurfaceHits{};
  if (job.rays.drawsPlainRays() && !p->look.tools.empty()) {
    hits = p->look.findTools(images, stop);
    if (!hits) return hits.error();
    job.tools = &*hits;
  }
  if (p->look.wantValues && job.mode != VolumeMode::Blend) p->look.allocateValues(images);
  return native::renderVolume(job, images, stop);
}

}  // namespace

Technique nativeVolumeTechnique(Host& host) {
  Technique t;
  t.name = "dvr.native";
  t.kinds = {"volume"};
  t.engine = Engine::Native;
  t.drawsParts = true;
  t.together = together;
  t.passesFor = passesFor;
  t.execute = [&host](const Pass& p, Images& i, std::stop_token s) {
    return execute(p, i, s, host.derivedData());
  };
  return t;
}

}  // namespace vernier::dvr
