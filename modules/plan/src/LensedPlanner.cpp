// SPDX-License-Identifier: GPL-3.0-or-later
// Layers with lenses before them: appearances by their own techniques, between the cutting of rays and the
// joining of their parts.
#include "LensedPlan.h"
#include "Planner.h"
#include "vernier/base/Guarded.h"

namespace vernier {

Result<std::vector<Candidate>> Planner::askLensed(std::size_t index) {
  std::vector<Candidate> candidates;
  std::string reasons;
  std::optional<Error> sceneFault;
  for (const Technique* lens : techniques_.drawing("lens")) {
    Result<Candidate> c = lensedBy(*lens, index);
    if (c && context_.quality.level == QualityLevel::Reference && c->fixedFunction)
      c = makeError(ErrorCode::NoTechnique,
                    "it filters with 8-bit weights of the card, which reference never takes");
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

Result<Pass> Planner::appearance(const Layer& layer, std::size_t index, Engine engine,
                                 const PlanContext& context) {
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
    Result<std::vector<Pass>> passes = guarded(t->name, [&] { return t->passesFor(layer, index, context); });
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

Result<Candidate> Planner::lensedBy(const Technique& lens, std::size_t index) {
  if (std::string why = notAskedFor(lens, nullptr, context_.quality, context_.capabilities); !why.empty())
    return makeError(ErrorCode::NoTechnique, why);
  PlanContext context = context_;
  context.appearances.assign(1 + context.lenses.size(), {});
  Result<Pass> outside = appearance(context_.scene.layers[index], index, lens.engine, context);
  if (!outside) return outside.error();
  context.appearances[0].accumulator = outside->accumulator;
  std::vector<Pass> inside;
  std::vector<std::size_t> insideOf;  // the lens of each
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
    insideOf.push_back(n);
  }
  std::vector<const Pass*> shown(context.lenses.size(), nullptr);
  for (std::size_t n = 0; n < inside.size(); ++n) shown[insideOf[n]] = &inside[n];
  std::optional<Pass> all = together(*outside, shown);
  context.together = all.has_value();
  const std::size_t first = context.lenses.front().layer;
  Result<std::vector<Pass>> own =
      guarded(lens.name, [&] { return lens.passesFor(context_.scene.layers[first], first, context); });
  if (!own) return own.error();
  if (own->size() != (all ? 1 : 2))
    return makeError(ErrorCode::PluginFailed, lens.name + " cuts and joins in two passes, or cuts in one.");
  for (Pass& pass : *own) pass.technique = lens.name, pass.engine = lens.engine;
  if (!all) return lensedCandidate(lens, *std::move(own), *std::move(outside), std::move(inside));
  own->push_back(*std::move(all));
  return candidateOf(lens, *std::move(own));
}

std::optional<Pass> Planner::together(const Pass& outside, const std::vector<const Pass*>& inside) const {
  const Technique* t = techniques_.find(outside.technique);
  if (!t || !t->together) return std::nullopt;
  std::vector<const Pass*> all{&outside};
  for (const Pass* pass : inside) {
    if (pass && pass->technique != outside.technique) return std::nullopt;
    all.push_back(pass);
  }
  std::optional<Pass> pass = t->together(all);
  if (!pass) return std::nullopt;
  pass->technique = outside.technique, pass->engine = outside.engine;
  pass->rays = {RaysOfPass::Which::Together, 0};
  return pass;
}

Candidate Planner::lensedCandidate(const Technique& lens, std::vector<Pass> own, Pass outside,
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
  return candidateOf(lens, std::move(passes));
}

Candidate Planner::candidateOf(const Technique& lens, std::vector<Pass> passes) {
  Candidate c{&lens, std::move(passes), 0, 0, false};
  for (const Pass& pass : c.passes) {
    c.ms += pass.predicted_ms;
    c.error = std::max(c.error, pass.predictedError);
    c.fixedFunction = c.fixedFunction || pass.fixedFunctionFiltering;
  }
  return c;
}

}  // namespace vernier
