// SPDX-License-Identifier: GPL-3.0-or-later
// Plans the layers of a scene, one after the other: asks the techniques, and takes the best. Planner.cpp;
// layers with lenses before them: LensedPlanner.cpp.
#pragma once
#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "vernier/plan/MakePlan.h"

namespace vernier {

struct Candidate {
  const Technique* technique = nullptr;
  std::vector<Pass> passes;
  double ms = 0, error = 0;
  bool fixedFunction = false;
};

// Why a technique is out before it is even asked; "" when it may be asked. `named`: the technique that was
// asked for, when it draws layers of this kind; those of other kinds are drawn as if none had been named.
std::string notAskedFor(const Technique& t, const Technique* named, const Quality& quality,
                        const Capabilities& machine);

std::string layerName(std::size_t index, const std::string& kind);

template <class Kind>
bool holds(const Scene& scene) {
  return std::any_of(scene.layers.begin(), scene.layers.end(),
                     [](const Layer& l) { return std::holds_alternative<Kind>(l); });
}

inline bool throughVolume(const Scene& scene) {
  return std::any_of(scene.layers.begin(), scene.layers.end(), looksThroughVolume);
}

// Plans one layer after the other into `plan`.
class Planner {
 public:
  Planner(const PlanContext& context, const TechniqueRegistry& techniques, Plan& plan)
      : context_(context), techniques_(techniques), plan_(plan), goal_(errorGoal(context.quality)) {}
  // The layer that context.lenses stand before.
  void setLensed(std::size_t layer) { lensed_ = layer; }
  Result<void> add(std::size_t index);

 private:
  void reject(const std::string& what, const std::string& why) { plan_.rejected.push_back({what, why}); }
  Result<std::vector<Candidate>> ask(const Layer& layer, std::size_t index,
                                     const std::vector<const Technique*>& drawing);
  // The picture of the layer with its lenses, once for each engine that can draw all of it.
  Result<std::vector<Candidate>> askLensed(std::size_t index);
  // The one pass of an appearance, by a technique of the lens's engine that draws parts of rays: the cheapest
  // that is predicted to stay within the goal, else the most exact.
  Result<Pass> appearance(const Layer& layer, std::size_t index, Engine engine, const PlanContext& context);
  Result<Candidate> lensedBy(const Technique& lens, std::size_t index);
  // All appearances by one pass, where they are of one technique that can; `inside`: null for nothing shown.
  std::optional<Pass> together(const Pass& outside, const std::vector<const Pass*>& inside) const;
  static Candidate candidateOf(const Technique& lens, std::vector<Pass> passes);
  static Candidate lensedCandidate(const Technique& lens, std::vector<Pass> own, Pass outside,
                                   std::vector<Pass> inside);
  void choose(std::vector<Candidate> candidates, std::size_t index, const std::string& kind);
  bool inTime(const Candidate& c) const;
  // A frame rate that was asked for goes before the goal that a quality level brings along, but not before an
  // error that was asked for too, nor before `reference`.
  bool rateFirst() const;
  std::string whyNot(const Candidate& c, const Candidate& best) const;
  const PlanContext& context_;
  const TechniqueRegistry& techniques_;
  Plan& plan_;
  double goal_;
  std::size_t lensed_ = std::numeric_limits<std::size_t>::max();
};

}  // namespace vernier
