// SPDX-License-Identifier: GPL-3.0-or-later
// Plan: the shortest list of passes that shows a scene, with what was rejected and why. Plain data.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "vernier/base/ConvexRegion.h"
#include "vernier/plan/Frame.h"
#include "vernier/plan/View.h"

namespace vernier {

// A technique's own parameters of one pass. Immutable; may hold the volume.
class VERNIER_API PassParams {
 public:
  virtual ~PassParams() = default;
  virtual std::string dump() const = 0;  // one line, no paths, no pointers
};

struct Resource {
  std::string name;  // "texture3d", "texture2d x 62", "bricks"
  std::uint64_t bytes = 0;
};

// GL state as the pass needs it, for the dump; the executor states all of it itself.
struct GlState {
  std::string blend = "off", depth = "off", cull = "off";
};

struct Pass {
  std::string name;  // "slice 0"
  Engine engine = Engine::Native;
  std::string technique;  // registered name, finds the executor
  std::vector<std::string> inputs, outputs;
  GlState gl;
  std::vector<Resource> resources;
  double predicted_ms = 0;
  double predictedError = 0;  // levels of 255
  // The pass interpolates with the card's texture unit, whose weights have 8 bits: never taken at
  // `reference`.
  bool fixedFunctionFiltering = false;
  RaysOfPass rays;                                 // set by the planner
  Accumulator accumulator = Accumulator::Ordered;  // of the layer along a ray; set by its technique
  std::vector<std::string> notes;  // what a reader must know of this pass; moved to Plan::notes
  std::shared_ptr<const PassParams> params;
};

struct Rejected {
  std::string what;  // technique or layer
  std::string why;   // one sentence
};

// A lens in its place, of the `layer`-th layer of the scene.
struct PlacedLens {
  std::shared_ptr<const ConvexRegion> region;
  std::size_t layer = 0;
};

struct Plan {
  std::vector<Pass> passes;
  std::vector<Rejected> rejected;
  std::vector<std::string> notes;       // "layer 1 (shells) needs plugin angiography: not shown"
  std::vector<std::string> afterwards;  // what is drawn over the picture when its error has been taken
  std::vector<PlacedLens> lenses;       // those that meet what is shown, in the scene's order
  bool showsWholeScene = true;          // false when a layer is kept but cannot be shown
};

// Stable text: the same plan gives the same bytes on every machine. Predictions are rounded (ms to 3 digits,
// error to 2), lists keep the plan's order.
VERNIER_API std::string dumpPlan(const Plan&);

}  // namespace vernier
