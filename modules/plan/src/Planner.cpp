// SPDX-License-Identifier: GPL-3.0-or-later
#include "Planner.h"

#include "Numbers.h"
#include "vernier/base/Guarded.h"

namespace vernier {
namespace {

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

}  // namespace

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

std::string layerName(std::size_t index, const std::string& kind) {
  return "layer " + std::to_string(index) + " (" + kind + ")";
}

Result<void> Planner::add(std::size_t index) {
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

Result<std::vector<Candidate>> Planner::ask(const Layer& layer, std::size_t index,
                                            const std::vector<const Technique*>& drawing) {
  std::vector<Candidate> candidates;
  std::string reasons;
  std::optional<Error> sceneFault;
  const auto refuse = [&](const Technique& t, const std::string& why) {
    reject(t.name, why);
    reasons += (reasons.empty() ? "" : "; ") + t.name + ": " + why;
  };
  const auto asked = std::find_if(drawing.begin(), drawing.end(),
                                  [&](const Technique* t) { return t->name == context_.quality.technique; });
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
    Result<std::vector<Pass>> passes = guarded(t->name, [&] { return t->passesFor(layer, index, context_); });
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

void Planner::choose(std::vector<Candidate> candidates, std::size_t index, const std::string& kind) {
  const bool preferNative = !context_.capabilities.gl || context_.capabilities.glIsSoftware;
  const auto nativeFirst = [&](const Candidate& c) {
    return preferNative && c.technique->engine == Engine::Native;
  };
  const auto fits = [&](const Candidate& c) { return c.error <= goal_; };
  const bool anyFits = std::any_of(candidates.begin(), candidates.end(), fits);
  const auto better = [&](const Candidate& a, const Candidate& b) {
    if (rateFirst() && inTime(a) != inTime(b)) return inTime(a);
    if (rateFirst() && !inTime(a)) return cheaper(a, b);  // neither: what comes closest to the rate
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
                          (context_.quality.minFps && rateFirst() ? " at the frame rate" : "") + " is taken");
  else if (!fits(*best))
    plan_.notes.push_back(layerName(index, kind) + ": predicted error " + rounded(best->error, 2) +
                          " levels, " + rounded(goal_, 3) + " wanted, for the frame rate that was asked for");
  for (Pass& pass : best->passes)
    plan_.notes.insert(plan_.notes.end(), std::make_move_iterator(pass.notes.begin()),
                       std::make_move_iterator(pass.notes.end()));
  for (Pass& pass : best->passes) pass.notes.clear();
  plan_.passes.insert(plan_.passes.end(), std::make_move_iterator(best->passes.begin()),
                      std::make_move_iterator(best->passes.end()));
}

bool Planner::inTime(const Candidate& c) const {
  return !context_.quality.minFps || c.ms * *context_.quality.minFps <= 1000;
}

bool Planner::rateFirst() const {
  return !context_.quality.maxError && context_.quality.level != QualityLevel::Reference;
}

std::string Planner::whyNot(const Candidate& c, const Candidate& best) const {
  if (c.error > goal_)
    return "predicted error " + rounded(c.error, 2) + " levels, " + rounded(goal_, 3) + " asked for";
  if (!inTime(c) && inTime(best))
    return "predicted " + rounded(c.ms, 3) + " ms, too slow for the " + rounded(*context_.quality.minFps, 3) +
           " frames per second asked for";
  if (best.technique->engine == Engine::Native && c.technique->engine == Engine::Gl &&
      context_.capabilities.glIsSoftware && c.ms <= best.ms)
    return "without a card native goes first";
  return "predicted " + rounded(c.ms, 3) + " ms, " + best.technique->name + " " + rounded(best.ms, 3) + " ms";
}

}  // namespace vernier
