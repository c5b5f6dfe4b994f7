// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/MakePlan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "LensedPlan.h"
#include "Numbers.h"
#include "vernier/base/Guarded.h"
#include "vernier/plan/Volumetric.h"

namespace vernier {
namespace {

struct Candidate {
  const Technique* technique = nullptr;
  std::vector<Pass> passes;
  double ms = 0, error = 0;
  bool fixedFunction = false;
};

// Why a technique is out before it is even asked; "" when it may be asked. `named`: the technique that was
// asked for, when it draws layers of this kind; those of other kinds are drawn as if none had been named.
std::string notAskedFor(const Technique& t, const Technique* named, const Quality& quality,
                        const Capabilities& machine) {
  if (named && named != &t) return "the technique " + named->name + " was asked for";
  if (quality.engine == EngineChoice::Native && t.engine != Engine::Native)
    return "it draws with gl, and native was asked for";
  if (quality.engine == EngineChoice::Gl && t.engine != Engine::Gl)
    return "it draws with native, and gl was asked for";
  if (t.engine == Engine::Native && !machine.native) return "the native engine is not available here";
  if (t.engine == Engine::Gl && !machine.gl)
    return "OpenGL is not available here" + (machine.glWhyNot.empty() ? "" : ": " + machine.glWhyNot);
  return "";
}

Candidate measured(const Technique& t, std::vector<Pass> passes) {
  Candidate c{&t, std::move(passes), 0, 0, false};
  for (Pass& pass : c.passes) {
    pass.technique = t.name;
    pass.engine = t.engine;
    c.ms += pass.predicted_ms;
    c.error = std::max(c.error, pass.predictedError);
    c.fixedFunction = c.fixedFunction || pass.fixedFunctionFiltering;
  }
  return c;
}

// Cheaper first, then more exact; equals keep the order of registration.
bool cheaper(const Candidate& a, const Candidate& b) {
  return a.ms != b.ms ? a.ms < b.ms : a.error < b.error;
}

std::string layerName(std::size_t index, const std::string& kind) {
  return "layer " + std::to_string(index) + " (" + kind + ")";
}

template <class Kind>
bool holds(const Scene& scene) {
  return std::any_of(scene.layers.begin(), scene.layers.end(),
                     [](const Layer& l) { return std::holds_alternative<Kind>(l); });
}

bool throughVolume(const Scene& scene) {
  return std::any_of(scene.layers.begin(), scene.layers.end(), looksThroughVolume);
}

// Plans one layer after the other into `plan`.
class Planner {
 public:
  Planner(const PlanContext& context, const TechniqueRegistry& techniques, Plan& plan)
      : context_(context), techniques_(techniques), plan_(plan), goal_(errorGoal(context.quality)) {}

  // The layer that context.lenses stand before.
  void setLensed(std::size_t layer) { lensed_ = layer; }

  Result<void> add(std::size_t index) {
    const Layer& layer = context_.scene.layers[index];
    const std::string kind = kindOf(layer);
    if (std::holds_alternative<SurfaceLayer>(layer) && holds<SliceLayer>(context_.scene)) {
      plan_.afterwards.push_back("outline of " + layerName(index, kind) + " on the slice");
      return {};
    }
    const std::vector<const Technique*> drawing = techniques_.drawing(kind);
    // The technique of the volume draws the tools that stand in it.
    if (std::holds_alternative<SurfaceLayer>(layer) && !drawing.empty() && throughVolume(context_.scene))
      return {};
    if (drawing.empty()) {
      const std::string plugin = pluginOf(kind);
      plan_.notes.push_back(
          layerName(index, kind) +
          (plugin.empty() ? " is of a kind that no plugin here draws" : " needs plugin " + plugin) +
          ": not shown");
      plan_.showsWholeScene = false;
      return {};
    }
    // Drawn with the layer that it looks into.
    if (std::holds_alternative<LensLayer>(layer)) return {};
    const bool lensed = index == lensed_ && !context_.lenses.empty();
    Result<std::vector<Candidate>> candidates =
        lensed && looksThroughVolume(layer) ? askLensed(index) : ask(layer, index, drawing);
    if (!candidates) return candidates.error();
    choose(std::move(*candidates), index, kind);
    return {};
  }

 private:
  void reject(const std::string& what, const std::string& why) { plan_.rejected.push_back({what, why}); }

  Result<std::vector<Candidate>> ask(const Layer& layer, std::size_t index,
                                     const std::vector<const Technique*>& drawing) {
    std::vector<Candidate> candidates;
    std::string reasons;
    std::optional<Error> sceneFault;
    const auto refuse = [&](const Technique& t, const std::string& why) {
      reject(t.name, why);
      reasons += (reasons.empty() ? "" : "; ") + t.name + ": " + why;
    };
    const auto asked = std::find_if(drawing.begin(), drawing.end(), [&](const Technique* t) {
      return t->name == context_.quality.technique;
    });
    for (const Technique* t : drawing) {
      if (std::string why = notAskedFor(*t, asked == drawing.end() ? nullptr : *asked, context_.quality,
                                        context_.capabilities);
          !why.empty()) {
        refuse(*t, why);
        continue;
      }
      if (!context_.lenses.empty() && index == lensed_ && !t->drawsLenses) {
        refuse(*t, "it draws no lenses");
        continue;
      }
      // The planner of a technique lives in a plugin: what it throws becomes its reason.
      Result<std::vector<Pass>> passes =
          guarded(t->name, [&] { return t->passesFor(layer, index, context_); });
      if (!passes) {
        const ErrorCode code = passes.error().code;
        if (!sceneFault && (code == ErrorCode::PlaneDegenerate || code == ErrorCode::PathDegenerate ||
                            code == ErrorCode::SceneInvalid))
          sceneFault = passes.error();
        refuse(*t, passes.error().sentence);
        continue;
      }
      Candidate c = measured(*t, std::move(*passes));
      if (context_.quality.level == QualityLevel::Reference && c.fixedFunction)
        refuse(*t, "it filters with 8-bit weights of the card, which reference never takes");
      else
        candidates.push_back(std::move(c));
    }
    if (!candidates.empty()) return candidates;
    // A fault of the scene is the same for every technique and says more than that none fits.
    if (sceneFault) return *sceneFault;
    return makeError(ErrorCode::NoTechnique,
                     "Nothing that may be used here can draw " + layerName(index, kindOf(layer)) + " (" +
                         reasons + "); ask for another engine, technique or quality.",
                     "/layers/" + std::to_string(index));
  }

  // The picture of the layer with its lenses, once for each engine that can draw all of it.
  Result<std::vector<Candidate>> askLensed(std::size_t index) {
    std::vector<Candidate> candidates;
    std::string reasons;
    std::optional<Error> sceneFault;
    for (const Technique* lens : techniques_.drawing("lens")) {
      Result<Candidate> c = lensedBy(*lens, index);
      if (c) {
        candidates.push_back(*std::move(c));
        continue;
      }
      if (!sceneFault && c.error().code == ErrorCode::SceneInvalid) sceneFault = c.error();
      reject(lens->name, c.error().sentence);
      reasons += (reasons.empty() ? "" : "; ") + lens->name + ": " + c.error().sentence;
    }
    if (!candidates.empty()) return candidates;
    if (sceneFault) return *sceneFault;
    return makeError(ErrorCode::NoTechnique,
                     "Nothing that may be used here can draw " +
                         layerName(index, kindOf(context_.scene.layers[index])) + " with a lens (" + reasons +
                         "); ask for another engine, technique or quality.",
                     "/layers/" + std::to_string(index));
  }

  // The one pass of an appearance, by a technique of the lens's engine that draws parts of rays: the cheapest
  // that is predicted to stay within the goal, else the most exact.
  Result<Pass> appearance(const Layer& layer, std::size_t index, Engine engine, const PlanContext& context) {
    std::string reasons;
    std::optional<Pass> best;
    const auto better = [&](const Pass& a, const Pass& b) {
      const bool fits = a.predictedError <= goal_, otherFits = b.predictedError <= goal_;
      if (fits != otherFits) return fits;
      return fits ? a.predicted_ms < b.predicted_ms : a.predictedError < b.predictedError;
    };
    for (const Technique* t : techniques_.drawing(kindOf(layer))) {
      if (t->engine != engine || !t->drawsParts) continue;
      const bool named = context_.quality.technique.empty() || context_.quality.technique == t->name;
      const auto kinds = techniques_.find(context_.quality.technique);
      if (!named && kinds && std::count(kinds->kinds.begin(), kinds->kinds.end(), kindOf(layer)) > 0) {
        reasons += (reasons.empty() ? "" : "; ") + kinds->name + " was asked for";
        continue;
      }
      Result<std::vector<Pass>> passes =
          guarded(t->name, [&] { return t->passesFor(layer, index, context); });
      if (passes && passes->size() == 1) {
        passes->front().technique = t->name;
        passes->front().engine = t->engine;
        if (!best || better(passes->front(), *best)) best = std::move(passes->front());
        continue;
      }
      if (!passes && passes.error().code == ErrorCode::SceneInvalid) return passes.error();
      reasons += (reasons.empty() ? "" : "; ") + t->name + ": " +
                 (passes ? "it needs more than one pass" : passes.error().sentence);
    }
    if (best) return *std::move(best);
    return makeError(ErrorCode::NoTechnique, "no technique of this engine draws parts of a " + kindOf(layer) +
                                                 (reasons.empty() ? "" : " here (" + reasons + ")"));
  }

  Result<Candidate> lensedBy(const Technique& lens, std::size_t index) {
    if (std::string why = notAskedFor(lens, nullptr, context_.quality, context_.capabilities); !why.empty())
      return makeError(ErrorCode::NoTechnique, why);
    PlanContext context = context_;
    context.appearances.assign(1 + context.lenses.size(), {});
    Result<Pass> outside = appearance(context_.scene.layers[index], index, lens.engine, context);
    if (!outside) return outside.error();
    context.appearances[0].accumulator = outside->accumulator;
    std::vector<Pass> inside;
    PlanContext bare = context;
    bare.tools.clear();  // the rays are cut at tools; whoever draws their parts sees none
    for (std::size_t n = 0; n < context.lenses.size(); ++n) {
      const std::size_t at = context.lenses[n].layer;
      const std::optional<Layer> inner = innerLayer(std::get<LensLayer>(context_.scene.layers[at]));
      PlanContext::Appearance& a = context.appearances[n + 1];
      a.empty = !inner;
      if (!inner) continue;
      Result<Pass> pass = appearance(*inner, at, lens.engine, bare);
      if (!pass) return pass.error();
      a.accumulator = pass->accumulator;
      pass->name = "inside of lens " + std::to_string(at) + ": " + pass->name;
      pass->rays = {RaysOfPass::Which::All, static_cast<std::int16_t>(n + 1)};
      inside.push_back(*std::move(pass));
    }
    const std::size_t first = context.lenses.front().layer;
    Result<std::vector<Pass>> own =
        guarded(lens.name, [&] { return lens.passesFor(context_.scene.layers[first], first, context); });
    if (!own) return own.error();
    if (own->size() != 2)
      return makeError(ErrorCode::PluginFailed, lens.name + " cuts and joins in two passes.");
    for (Pass& pass : *own) pass.technique = lens.name, pass.engine = lens.engine;
    return lensedCandidate(lens, *std::move(own), *std::move(outside), std::move(inside));
  }

  static Candidate lensedCandidate(const Technique& lens, std::vector<Pass> own, Pass outside,
                                   std::vector<Pass> inside) {
    const bool ordered = outside.accumulator == Accumulator::Ordered;
    std::vector<Pass> passes{std::move(own[0])};
    outside.rays = {ordered ? RaysOfPass::Which::First : RaysOfPass::Which::All, 0};
    Pass rest = outside;
    passes.push_back(std::move(outside));
    for (Pass& pass : inside) passes.push_back(std::move(pass));
    if (ordered) {
      rest.name += ", behind";
      rest.rays.which = RaysOfPass::Which::Rest;
      rest.predicted_ms = 0;  // its rays are cut, not more
      rest.notes.clear(), rest.resources.clear();
      passes.push_back(std::move(rest));
    }
    passes.push_back(std::move(own[1]));
    Candidate c{&lens, std::move(passes), 0, 0, false};
    for (const Pass& pass : c.passes) {
      c.ms += pass.predicted_ms;
      c.error = std::max(c.error, pass.predictedError);
      c.fixedFunction = c.fixedFunction || pass.fixedFunctionFiltering;
    }
    return c;
  }

  void choose(std::vector<Candidate> candidates, std::size_t index, const std::string& kind) {
    const bool preferNative = !context_.capabilities.gl || context_.capabilities.glIsSoftware;
    const auto nativeFirst = [&](const Candidate& c) {
      return preferNative && c.technique->engine == Engine::Native;
    };
    const auto fits = [&](const Candidate& c) { return c.error <= goal_; };
    const bool anyFits = std::any_of(candidates.begin(), candidates.end(), fits);
    const auto better = [&](const Candidate& a, const Candidate& b) {
      if (rateFirst() && inTime(a) != inTime(b)) return inTime(a);
      if (fits(a) != fits(b)) return fits(a);
      if (inTime(a) != inTime(b)) return inTime(a);
      if (!anyFits && a.error != b.error) return a.error < b.error;
      if (nativeFirst(a) != nativeFirst(b)) return nativeFirst(a);
      return cheaper(a, b);
    };
    const auto best = std::min_element(candidates.begin(), candidates.end(), better);
    for (const Candidate& c : candidates)
      if (&c != &*best) reject(c.technique->name, whyNot(c, *best));
    if (!anyFits)
      plan_.notes.push_back(layerName(index, kind) + ": no technique is predicted to stay within " +
                            rounded(goal_, 3) + " levels; the most exact one" +
                            (context_.quality.minFps && rateFirst() ? " at the frame rate" : "") +
                            " is taken");
    else if (!fits(*best))
      plan_.notes.push_back(layerName(index, kind) + ": predicted error " + rounded(best->error, 2) +
                            " levels, " + rounded(goal_, 3) +
                            " wanted, for the frame rate that was asked for");
    for (Pass& pass : best->passes)
      plan_.notes.insert(plan_.notes.end(), std::make_move_iterator(pass.notes.begin()),
                         std::make_move_iterator(pass.notes.end()));
    for (Pass& pass : best->passes) pass.notes.clear();
    plan_.passes.insert(plan_.passes.end(), std::make_move_iterator(best->passes.begin()),
                        std::make_move_iterator(best->passes.end()));
  }

  bool inTime(const Candidate& c) const {
    return !context_.quality.minFps || c.ms * *context_.quality.minFps <= 1000;
  }
  // A frame rate that was asked for goes before the goal that a quality level brings along, but not before an
  // error that was asked for too, nor before `reference`.
  bool rateFirst() const {
    return !context_.quality.maxError && context_.quality.level != QualityLevel::Reference;
  }

  std::string whyNot(const Candidate& c, const Candidate& best) const {
    if (c.error > goal_)
      return "predicted error " + rounded(c.error, 2) + " levels, " + rounded(goal_, 3) + " asked for";
    if (!inTime(c) && inTime(best))
      return "predicted " + rounded(c.ms, 3) + " ms, too slow for the " +
             rounded(*context_.quality.minFps, 3) + " frames per second asked for";
    if (best.technique->engine == Engine::Native && c.technique->engine == Engine::Gl &&
        context_.capabilities.glIsSoftware && c.ms <= best.ms)
      return "without a card native goes first";
    return "predicted " + rounded(c.ms, 3) + " ms, " + best.technique->name + " " + rounded(best.ms, 3) +
           " ms";
  }

  const PlanContext& context_;
  const TechniqueRegistry& techniques_;
  Plan& plan_;
  double goal_;
  std::size_t lensed_ = std::numeric_limits<std::size_t>::max();
};

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
