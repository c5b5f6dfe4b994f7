// SPDX-License-Identifier: GPL-3.0-or-later
// makePlan: Scene + View + Quality + Capabilities + costs -> Plan. Pure and deterministic; a few microseconds.
//
// Choice per layer: of the techniques that draw its kind and accept it, those of the engine and name asked for; of
// these the cheapest by predicted ms whose predicted error fits the quality level (Reference never takes a technique
// with fixed-function filtering); without a card native wins where it can show the layer. Every other candidate
// stands in Plan::rejected with its reason. A layer whose kind nobody draws is kept and named in Plan::notes.
// Errors: SceneInvalid (no layers), NoTechnique (an engine or technique that was asked for cannot draw a layer, with
// its reason), PlaneDegenerate.
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier {

VERNIER_API Result<Plan> makePlan(const Scene&, const View&, const Quality&, const Capabilities&, const CostTable&,
                                  const Sources&, const TechniqueRegistry&);

// The plugin that draws a kind: "slice" -> "mpr", "shells" -> "angiography"...; "" for unknown kinds.
VERNIER_API std::string pluginOf(const std::string& kind);

}  // namespace vernier
