// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a mesh is the surface of a convex body, to 1e-5 of its size: what files with float32 or six digits
// can say.
#pragma once
#include "Solid.h"
#include "vernier/volume/Mesh.h"

namespace vernier::lens {

// SceneInvalid with the reason when it is not. Before the hull is made: closed, each edge convex.
Result<void> checkEdges(const Mesh&);
// It fills its hull.
Result<void> checkFilled(const Mesh&, const Solid& hull);
double volume_mm3(const Solid&);

}  // namespace vernier::lens
