// SPDX-License-Identifier: GPL-3.0-or-later
#include "ShellParams.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "DumpNumber.h"
#include "vernier/volume/IsoSurface.h"
#include "vernier/volume/Voi.h"

namespace vernier::angiography {
namespace {

std::string exact(double v) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v);
  return std::string(text, end.ptr);
}

Error invalid(std::size_t layer, const char* key, const std::string& sentence) {
  return makeError(ErrorCode::SceneInvalid, sentence, "/layers/" + std::to_string(layer) + "/" + key);
}

Result<void> checkBrightness(const ShellsLayer& l, std::size_t index) {
  const struct {
    const char* key;
    double value;
  } numbers[] = {{"beta0", l.beta0}, {"beta_m", l.betaM}, {"a", l.a}, {"b", l.b}, {"phi0", l.phi0}};
  for (const auto& n : numbers)
    if (!(n.value >= 0) || !std::isfinite(n.value))
      return invalid(index, n.key, "The numbers of a shells layer's brightness are finite and not below 0.");
  if (!(l.betaM > 0)) return invalid(index, "beta_m", "The slope of the depth ramp must be above 0.");
  return {};
}

// A histogram reads every voxel: once per volume and window, not once per picture.
Result<std::vector<double>> levelsOf(const ShellsLayer& layer, const Volume& volume, ShellStore& store) {
  using Levels = std::vector<double>;
  if (!layer.levels.empty() || layer.spread == LevelSpread::Even) return shellLevels(layer, volume);
  const VoiWindow& w = *layer.window;
  const DerivedCache::Key key{"shell-levels", volume.revision(),
                              std::to_string(layer.count) + " " + exact(w.center) + " " + exact(w.width) +
                                  " " + std::to_string(static_cast<int>(w.function))};
  const auto kept = store.cache().get<Levels>(key, [&]() -> Result<DerivedCache::Made<Levels>> {
    Result<Levels> made = shellLevels(layer, volume);
    if (!made) return made.error();
    const std::uint64_t bytes = made->size() * sizeof(double);
    return DerivedCache::Made<Levels>{std::make_shared<Levels>(std::move(*made)), bytes};
  });
  if (!kept) return kept.error();
  return **kept;
}

// Those that are drawn.
Result<std::vector<double>> enabledLevels(const ShellsLayer& layer, const Volume& volume, ShellStore& store) {
  Result<std::vector<double>> levels = levelsOf(layer, volume, store);
  if (!levels) return levels;
  std::vector<double> enabled;
  for (std::size_t n = 0; n < levels->size(); ++n)
    if (std::find(layer.disabled.begin(), layer.disabled.end(), static_cast<int>(n)) == layer.disabled.end())
      enabled.push_back((*levels)[n]);
  return enabled;
}

ShellsLayer withWindow(ShellsLayer layer, const Volume& volume) {
  layer.window = normalised(layer.window.value_or(wholeRange(volume)));
  return layer;
}

// Which appearances of a picture with lenses show the level sets that the layer has: closed surfaces, or what
// is lit of them.
std::vector<bool> goingOn(const ShellsLayer& layer, const std::vector<double>& levels, const Volume& volume,
                          const PlanContext& context, ShellStore& store) {
  std::vector<bool> out;
  const auto add = [&](const auto& shown) {
    const auto* other = std::get_if<ShellsLayer>(&shown);
    if (!other || (other->mode == ShellsMode::Lit) != (layer.mode == ShellsMode::Lit) ||
        other->source != layer.source)
      return out.push_back(false);
    const Result<std::vector<double>> theirs = enabledLevels(withWindow(*other, volume), volume, store);
    out.push_back(theirs && *theirs == levels);
  };
  const auto& layers = context.scene.layers;
  const auto behind = std::find_if(layers.begin(), layers.end(), looksThroughVolume);
  if (context.lenses.empty() || behind == layers.end()) return out;
  add(*behind);
  for (const PlacedLens& l : context.lenses) add(std::get<LensLayer>(layers[l.layer]).inner);
  return out;
}

std::uint64_t estimateOf(const std::vector<double>& levels, const Volume& volume, ShellStore& store) {
  using Estimate = std::uint64_t;
  std::string name;
  for (const double v : levels) name += exact(v) + " ";
  const auto kept = store.cache().get<Estimate>(
      {"shell-triangles", volume.revision(), name}, [&]() -> Result<DerivedCache::Made<Estimate>> {
        Estimate sum = 0;
        for (const std::uint64_t n : estimateIsoTriangles(volume, levels)) sum += n;
        return DerivedCache::Made<Estimate>{std::make_shared<Estimate>(sum), sizeof sum};
      });
  return kept ? **kept : 0;
}

std::string megabytes(std::uint64_t bytes) { return std::to_string((bytes + (1u << 20) - 1) >> 20) + " MB"; }

Result<void> checkMemory(const ShellParams& p, ShellStore& store) {
  const std::uint64_t needed = kIsoBytesPerTriangle * p.triangles + p.working_bytes;
  if (needed <= store.cache().limit()) return {};
  return makeError(ErrorCode::OutOfMemory, "The shells of " + std::to_string(p.job.shells.size()) +
                                               " levels need about " + megabytes(needed) + " and " +
                                               megabytes(store.cache().limit()) +
                                               " may be used; take fewer levels, or levels above the noise.");
}

const char* nameOf(ShellsMode mode) {
  return mode == ShellsMode::Max ? "max" : mode == ShellsMode::Sum ? "sum" : "lit";
}

}  // namespace

std::string ShellParams::dump() const {
  std::string s = std::string(nameOf(job.mode)) + ", " + std::to_string(job.shells.size()) + " of " +
                  std::to_string(levels) + " levels";
  if (!job.shells.empty())
    s += " from " + number(job.shells.front().level) + " to " + number(job.shells.back().level);
  s += ", beta0 " + number(job.beta0) + ", beta_m " + number(job.betaM) + ", a " + number(job.a) + ", b " +
       number(job.b);
  s += job.camera.projection == Projection::Perspective ? "; perspective" : "; orthographic";
  s += ", pixel " + number(job.camera.mmPerPixel()) + " mm";
  if (native::isCut(job)) s += ", cut open";
  if (!job.tools.empty()) s += "; " + std::to_string(job.tools.size()) + " tools";
  if (!job.tools.empty() && job.surfaceBlend == SurfaceBlend::Max) s += ", the brighter";
  return s;
}

Result<std::shared_ptr<const ShellParams>> shellParams(const Layer& any, std::size_t index,
                                                       const PlanContext& context, ShellStore& store) {
  const auto* given = std::get_if<ShellsLayer>(&any);
  if (!given) return makeError(ErrorCode::SceneInvalid, "The layer is no set of shells.");
  const auto found = context.sources.volumes.find(given->source);
  if (found == context.sources.volumes.end() || !found->second)
    return invalid(index, "source", "The volume that the layer names is not loaded.");
  const Volume& volume = *found->second;
  if (volume.isColour())
    return invalid(
        index, "source",
        "The layer's volume is in colour and has no values that shells could be made of; show it as "
        "slices.");
  if (const Result<void> ok = checkBrightness(*given, index); !ok) return ok.error();
  ShellsLayer layer = *given;
  layer.window = layer.window.value_or(wholeRange(volume));
  if (!usableWindow(*layer.window)) return invalid(index, "window", "The window needs a width above 0.");
  layer.window = normalised(*layer.window);
  const Result<std::vector<double>> levels = levelsOf(layer, volume, store);
  if (!levels) return invalid(index, "levels", levels.error().sentence);

  auto p = std::make_shared<ShellParams>();
  native::ShellsJob& job = p->job;
  Result<std::vector<HalfSpace>> kept = keptRegion(context.scene, volume.grid());
  if (!kept) return kept.error();
  job.kept = std::move(*kept);
  Result<CameraPicture> camera = cameraPicture(context.scene.camera, context.view, cameraBox(volume.grid()));
  if (!camera) return camera.error();
  job.camera = *camera;
  job.ramp = depthRamp(job.camera, volume.grid(), layer.cueByDistance);
  job.volume = found->second;
  job.mode = layer.mode;
  job.beta0 = layer.beta0, job.betaM = layer.betaM, job.a = layer.a, job.b = layer.b, job.phi0 = layer.phi0;
  job.colour = {layer.colour.r, layer.colour.g, layer.colour.b};
  job.surfaceBlend = layer.surfaceBlend;
  job.background = {context.scene.background.r, context.scene.background.g, context.scene.background.b};
  job.tools = context.tools;
  for (const PlacedLens& lens : context.lenses) job.lenses.push_back(lens.region);
  std::vector<double> enabled;
  for (std::size_t n = 0; n < levels->size(); ++n) {
    if (std::find(layer.disabled.begin(), layer.disabled.end(), static_cast<int>(n)) != layer.disabled.end())
      continue;
    enabled.push_back((*levels)[n]);
    job.shells.push_back({(*levels)[n], applyVoi(*layer.window, (*levels)[n]), nullptr});
  }
  job.goesOn = goingOn(layer, enabled, volume, context, store);
  p->levels = levels->size();
  p->working_bytes = isoWorkingBytes(volume.grid(), context.capabilities.threads);
  p->triangles = estimateOf(enabled, volume, store);
  if (const Result<void> ok = checkMemory(*p, store); !ok) return ok.error();
  return std::shared_ptr<const ShellParams>(std::move(p));
}

Result<native::ShellsJob> withMeshes(const ShellParams& p, ShellStore& store, std::stop_token stop) {
  native::ShellsJob job = p.job;
  std::vector<double> levels;
  for (const native::Shell& s : job.shells) levels.push_back(s.level);
  const Result<IsoSurfaces> made = isoSurfaces(*job.volume, levels, store.cache(), stop);
  if (!made) return made.error();
  store.extracted += made->extracted;
  for (std::size_t n = 0; n < job.shells.size(); ++n) job.shells[n].mesh = made->meshes[n];
  return job;
}

namespace {

// Levels that no value passes are said, since the picture is then emptier, or fuller, than was asked for.
void noteOutside(const native::ShellsJob& job, std::vector<std::string>& notes) {
  const auto range = job.volume->modalityRange();
  if (!range) return;
  const auto count = [&](auto&& outside) {
    return std::count_if(job.shells.begin(), job.shells.end(),
                         [&](const native::Shell& s) { return outside(s.level); });
  };
  const std::string of = " of " + std::to_string(job.shells.size()) + " levels lie ";
  if (const auto n = count([&](double level) { return level > range->max; }); n > 0)
    notes.push_back(std::to_string(n) + of + "above all values of the volume, at most " + number(range->max) +
                    ", and show nothing");
  if (const auto n = count([&](double level) { return level <= range->min; }); n > 0)
    notes.push_back(std::to_string(n) + of + "below all values of the volume, at least " +
                    number(range->min) + ", and show its box");
}

}  // namespace

Pass shellPass(const std::shared_ptr<const ShellParams>& p, std::size_t index) {
  // Against the continuous truth, 99 % of pixels, measured (docs/performance.md). Maximum: within a step
  // between levels, 36 at 6 levels, 20 at 12; but 9 at 64, since triangles are no level sets, and hardly
  // better with more. Sum and lit: where levels lie in noise some rays cross other shells than the mesh's; on
  // smooth data they come within 4 and 0.1.
  constexpr double kLeast = 8.6, kPerLevel = 255, kSum = 60, kLit = 100;
  Pass pass;
  pass.name = "shells " + std::to_string(index);
  pass.accumulator = p->job.mode == ShellsMode::Max   ? Accumulator::Max
                     : p->job.mode == ShellsMode::Sum ? Accumulator::Sum
                                                      : Accumulator::Ordered;
  pass.inputs = {"shell meshes"};
  if (!p->job.tools.empty()) pass.inputs.push_back("tools");
  pass.outputs = {"colour", "depth"};
  pass.resources = {{"shell meshes", kIsoBytesPerTriangle * p->triangles},
                    {"while extracting", p->working_bytes}};
  const double count = static_cast<double>(p->job.shells.size());
  pass.predictedError = p->job.mode == ShellsMode::Max   ? std::max(kLeast, kPerLevel / (count + 1))
                        : p->job.mode == ShellsMode::Sum ? kSum
                                                         : kLit;
  pass.notes = {
      "shells are steps, and no bound of the true values: the surfaces of marching cubes lie above "
      "them in places"};
  if (p->job.shells.size() < p->levels)
    pass.notes.push_back(std::to_string(p->levels - p->job.shells.size()) + " of " +
                         std::to_string(p->levels) + " levels are disabled");
  noteOutside(p->job, pass.notes);
  pass.params = p;
  return pass;
}

}  // namespace vernier::angiography
