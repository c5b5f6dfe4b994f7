// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses as the planner sees them: which of them meet what is shown, and what is inside.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/plan/MakePlan.h"

namespace vernier {

// The layer that a lens stands before: the one that looks through a volume, else the slice. SceneInvalid when
// there are lenses and neither. nullopt: no lens.
Result<std::optional<std::size_t>> layerBehindLenses(const Scene&);

// The lenses that meet what the layer shows of its volume to this camera, in the scene's order; the others
// are said in `notes`. SceneInvalid, with the JSON path, for a shape without volume and for an inside that
// the layer cannot have. `region`: Technique::region.
Result<std::vector<PlacedLens>> lensesBefore(std::size_t layer, const PlanContext&, const Technique& lens,
                                             std::vector<std::string>& notes);

// What a lens shows inside, as a layer; nullopt: nothing.
std::optional<Layer> innerLayer(const LensLayer&);

// Whether the region and the closed intersection of the half-spaces have a point in common. `corners`: of a
// closed mesh that the half-spaces are cut from, for a region that holds them all.
bool meets(const ConvexRegion&, std::span<const HalfSpace>, const std::vector<PatientPoint>& corners);

}  // namespace vernier
