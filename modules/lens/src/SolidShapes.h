// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes in closed form, in the lens's frame. SceneInvalid for what has no volume.
#pragma once
#include "Solid.h"

namespace vernier::lens {

Result<Solid> boxSolid(const BoxShape&);
// Of radius 1 about the origin: an icosahedron, each triangle divided in four `divisions` times, 0..5, new
// corners brought out to the sphere.
Solid icosphere(int divisions);
// The lens-frame map that makes the sphere of an icosphere, after it was checked.
Result<Transform<MeshFrame, MeshFrame>> spherePlace(const SphereShape&);
// A prism: corner 0 of each ring lies along the coordinate axis that is most across the cone's own. An end
// too thin for a ring that float32 can hold becomes a point, or both get fewer sides, and `notice` says so.
Result<Solid> coneSolid(const ConeShape&);

// SceneInvalid unless the number is a size: finite, kLeast_mm..kFarthest_mm. `what`: "The sphere's radius".
Result<void> checkSize(const char* what, double v);
Result<void> checkPoint(const char* what, const MeshPoint& p);

}  // namespace vernier::lens
