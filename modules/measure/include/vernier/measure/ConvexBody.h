// SPDX-License-Identifier: GPL-3.0-or-later
// The body that half-spaces enclose: volume by the divergence theorem over its faces, in double. Pure.
#pragma once
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "vernier/base/HalfSpace.h"
#include "vernier/base/Result.h"

namespace vernier::measure {

struct ConvexBody {
  double volume_mm3 = 0;
  std::vector<double>
      faces;  // area of each plane's face, mm2, in the order given; 0: the plane takes no part
  std::vector<glm::dvec3> normals;
  std::vector<glm::dvec3> corners;  // of all faces, patient mm; a corner stands once for each of its faces
};

// OptionInvalid when the planes enclose nothing, when the body is open (not bounded on all sides), when
// a normal is no unit vector (to 1e-6), or when there are over kMostPlanes.
VERNIER_API Result<ConvexBody> convexBody(std::span<const HalfSpace>);

}  // namespace vernier::measure
