// SPDX-License-Identifier: GPL-3.0-or-later
// A hull without what only rounding made: facets that are one plane are one facet, corners within a face or
// on an edge go, and so do triangles too thin for float32.
#pragma once
#include "HullSolid.h"

namespace vernier::lens {

// SceneInvalid when nothing is left of it but a flat one.
Result<Solid> cleanHull(std::vector<glm::dvec3> points, const HullScale&);

}  // namespace vernier::lens
