// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/MakePlan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "LensedPlan.h"
#include "Numbers.h"
#include "Planner.h"
#include "vernier/plan/Volumetric.h"

namespace vernier {
namespace {

// A whole-picture layer covers what lies under it: two of them need a way to be combined, which is not built
// yet. Surfaces are combined by the technique that draws them or the volume around them; on a slice they are
// outlines. Layers that nothing here draws stand in nobody's way.
Result<void> checkPairs(const Scene& scene, const TechniqueRegistry& techniques) {
  std::optional<std::size_t> first;
  const bool takesSurfaces = holds<SliceLayer>(scene) || throughVolume(scene);
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    if (std::holds_alternative<CustomLayer>(scene.layers[i]) ||
        techniques.drawing(kindOf(scene.layers[i])).empty())
      continue;
    if (std::holds_alternative<LensLayer>(scene.layers[i])) continue;
    const bool surface = std::holds_alternative<SurfaceLayer>(scene.layers[i]);
    if (surface && (takesSurfaces || (first && std::holds_alternative<SurfaceLayer>(scene.layers[*first]))))
      continue;
    if (first)
      return makeError(ErrorCode::NotBuiltYet,
                       layerName(*first, kindOf(scene.layers[*first])) + " and " +
                           layerName(i, kindOf(scene.layers[i])) +
                           " cannot be shown in one picture yet; keep one of them.",
                       "/layers/" + std::to_string(i));
    first = i;
  }
  return {};
}

}  // namespace

double errorGoal(const Quality& quality) {
  if (quality.maxError) return *quality.maxError;
  switch (quality.level) {
    case QualityLevel::Review:
      return 2.0;
    case QualityLevel::Reference:
      return 0.5;
    case QualityLevel::Draft:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

Result<Plan> makePlan(const Scene& scene, const View& view, const Quality& quality,
                      const Capabilities& capabilities, const CostTable& costs, const Sources& sources,
                      const TechniqueRegistry& techniques) {
  if (scene.layers.empty())
    return makeError(ErrorCode::SceneInvalid,
                     "The scene has no layers, so there is nothing to show; add one.", "/layers");
  if (view.width_px < 1 || view.height_px < 1)
    return makeError(ErrorCode::SceneInvalid,
                     "The picture has no pixels; give it a width and a height above 0.");
  if (!std::isfinite(scene.camera.zoom) || !(scene.camera.zoom > 0))
    return makeError(ErrorCode::SceneInvalid, "The camera's zoom must be a number above 0.", "/camera/zoom");
  if (!quality.technique.empty() && !techniques.find(quality.technique)) {
    std::string known;
    for (const Technique& t : techniques.all()) known += (known.empty() ? "" : ", ") + t.name;
    return makeError(ErrorCode::NoTechnique,
                     "No technique is called '" + quality.technique +
                         "'; there are: " + (known.empty() ? "none (no plugin is loaded)" : known) + ".");
  }
  if (const Technique* named = techniques.find(quality.technique)) {
    const auto draws = [&](const Layer& l) {
      return std::find(named->kinds.begin(), named->kinds.end(), kindOf(l)) != named->kinds.end();
    };
    if (std::none_of(scene.layers.begin(), scene.layers.end(), draws))
      return makeError(ErrorCode::NoTechnique, "The technique " + named->name +
                                                   " draws no layer of this scene; ask for "
                                                   "another one, or for none.");
  }
  if (Result<void> pairs = checkPairs(scene, techniques); !pairs) return pairs.error();

  Plan plan;
  PlanContext context{scene, view, quality, capabilities, costs, sources};
  if (throughVolume(scene) && !techniques.drawing("surface").empty()) {
    Result<std::vector<PlacedSurface>> tools = placedSurfaces(scene, sources);
    if (!tools) return tools.error();
    context.tools = std::move(*tools);
  }
  if (!throughVolume(scene) && (scene.crop || !scene.clip.empty()))
    plan.notes.push_back(
        "crop box and clip planes cut layers that look through a volume; there is none here");
  Result<std::optional<std::size_t>> lensed = layerBehindLenses(scene);
  if (!lensed) return lensed.error();
  const std::vector<const Technique*> lensTechniques = techniques.drawing("lens");
  if (*lensed && !lensTechniques.empty()) {
    Result<std::vector<PlacedLens>> lenses =
        lensesBefore(**lensed, context, *lensTechniques.front(), plan.notes);
    if (!lenses) return lenses.error();
    context.lenses = *std::move(lenses);
    plan.lenses = context.lenses;
  }
  Planner planner(context, techniques, plan);
  if (*lensed) planner.setLensed(**lensed);
  for (std::size_t i = 0; i < scene.layers.size(); ++i)
    if (Result<void> added = planner.add(i); !added) return added.error();

  if (quality.minFps) {
    double ms = 0;
    for (const Pass& pass : plan.passes) ms += pass.predicted_ms;
    if (ms * *quality.minFps > 1000)
      plan.notes.push_back("predicted " + rounded(1000 / ms, 3) + " frames per second, " +
                           rounded(*quality.minFps, 3) + " asked for");
  }
  return plan;
}

std::string pluginOf(const std::string& kind) {
  struct Row {
    const char *kind, *plugin;
  };
  constexpr Row rows[] = {
      {"image", "mpr"},          {"slice", "mpr"},  {"curved", "mpr"},     {"projection", "angiography"},
      {"shells", "angiography"}, {"volume", "dvr"}, {"isosurface", "dvr"}, {"surface", "surgery"},
      {"lens", "lens"}};
  for (const Row& row : rows)
    if (kind == row.kind) return row.plugin;
  const std::size_t dot = kind.find('.');
  return dot == std::string::npos ? "" : kind.substr(0, dot);
}

}  // namespace vernier
