// SPDX-License-Identifier: GPL-3.0-or-later
// makePlan: Scene + View + Quality + Capabilities + costs -> Plan. Pure and deterministic; a few
// microseconds.
//
// Choice per layer: of the techniques that draw its kind and accept it, those of the engine and name asked
// for; of these the cheapest by predicted ms whose predicted error fits the goal (maxError, else 2 levels of
// 255 at review, 0.5 at reference, none at draft; Reference never takes a technique with fixed-function
// filtering); without a card native wins where it can show the layer. With minFps, techniques whose predicted
// ms fit the rate go first: before the error goal of a quality level, after a maxError and after Reference's
// goal; a note says when the rate or the goal is missed. When none fits the goal, the one with
// the least predicted error is taken and a note says so. Ties: less error, then the one registered first.
// Every other candidate stands in Plan::rejected with its reason. A layer whose kind nobody draws is kept and
// named in Plan::notes. Errors: SceneInvalid (no layers, a picture without pixels), NoTechnique (nothing that
// was asked for can draw a layer, with the reasons), NotBuiltYet (two layers that cannot be combined yet),
// PlaneDegenerate, PathDegenerate.
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier {

VERNIER_API Result<Plan> makePlan(const Scene&, const View&, const Quality&, const Capabilities&,
                                  const CostTable&, const Sources&, const TechniqueRegistry&);

// The largest error in levels of 255 that a quality asks for; +inf where there is no limit.
VERNIER_API double errorGoal(const Quality&);

// The plugin that draws a kind: "slice" -> "mpr", "shells" -> "angiography"...; of a plugin's own kinds what
// stands before the first dot, "acme.flow" -> "acme"; "" for others.
VERNIER_API std::string pluginOf(const std::string& kind);

}  // namespace vernier
