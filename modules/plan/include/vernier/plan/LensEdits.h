// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses by hand: what to put at a picked point, and edits of a scene's lenses. All are pure: each gives a
// new scene, so that an undo is the scene of before. Millimetres in the patient, degrees.
//
// A lens's middle is its box's or sphere's centre, halfway along a cone, the middle of the box around a
// hull's points, and of a mesh the origin of its own frame. It is what is placed, dragged, turned about and
// scaled about; edits change the pose alone, so that nothing of the shape is made again.
//
// SceneInvalid, with the layer's path: there is no such lens, numbers that are not finite, a factor or radius
// not above 0, an axis of length 0, a pose that flattens.
#pragma once
#include <cstddef>
#include <optional>

#include "vernier/plan/CameraPicture.h"
#include "vernier/plan/Scene.h"

namespace vernier {

// What is seen inside of a lens put at a picked point.
//   Bone      slices: the bone window; through a volume: its iso-surface at the level of bone (in CT 300 HU)
//   Vessels   slices: as Bone; through a volume: the maximum on the ray
//   CutOut    nothing
enum class LensPreset { Bone, Vessels, CutOut };
VERNIER_API LensInner lensInner(LensPreset, const Layer& behind);
// A sphere about the point, with what the preset shows of the layer behind it.
VERNIER_API LensLayer lensAt(LensPreset, const Layer& behind, PatientPoint at, double radius_mm);
// Along a trajectory: wide where it enters the skin, narrow at its target; what is inside is cut out.
VERNIER_API LensLayer trajectoryLens(PatientPoint skin, PatientPoint target, double skinRadius_mm,
                                     double targetRadius_mm);
// What a lens without a choice shows: on slices the bone window (`hounsfield`: the values are HU), else
// inverted; in a volume rendering the iso-surface; in an iso-surface the maximum; in projections and shells
// the volume rendering.
VERNIER_API LensInner defaultLensInner(const Layer& behind, bool hounsfield);
// The layer that the scene's lenses look into; null: none.
VERNIER_API const Layer* layerBehindLens(const Scene&);

VERNIER_API PatientPoint middleOf(const LensLayer&);

// The lens becomes the last layer: it wins over those before it. SceneInvalid when it has nothing to look
// into.
VERNIER_API Result<Scene> addLens(Scene, LensLayer);
VERNIER_API Result<Scene> removeLens(Scene, std::size_t layer);
VERNIER_API Result<Scene> placeLens(Scene, std::size_t layer, PatientPoint middle);
VERNIER_API Result<Scene> moveLens(Scene, std::size_t layer, PatientVec by);
// As the pointer goes from one pixel to another (centres at half-integers): the middle moves across the
// picture and keeps its depth. SceneInvalid when it is behind the eye.
VERNIER_API Result<Scene> dragLens(Scene, std::size_t layer, const CameraPicture&, glm::dvec2 from,
                                   glm::dvec2 to);
// Counterclockwise, seen from where the axis points to.
VERNIER_API Result<Scene> turnLens(Scene, std::size_t layer, PatientVec axis, double degrees);
// Along the axes of the lens's own frame.
VERNIER_API Result<Scene> scaleLens(Scene, std::size_t layer, glm::dvec3 factors);
VERNIER_API Result<Scene> setLensInner(Scene, std::size_t layer, LensInner);

}  // namespace vernier
