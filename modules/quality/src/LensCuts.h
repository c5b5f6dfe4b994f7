// SPDX-License-Identifier: GPL-3.0-or-later
// Rays cut at the faces of lenses: exact intervals of half-spaces, of any number of faces and lenses.
#pragma once
#include <vector>

#include "VolumeRays.h"

namespace vernier::quality {

// A stretch of a ray with one appearance: 0 is the outside, n the inside of the n-th lens from 1.
struct LensPart {
  double begin_mm = 0, end_mm = 0;
  std::size_t appearance = 0;
  Border begunBy = Border::Box, endedBy = Border::Box;
  glm::dvec3 beginNormal{0, 0, 1};
};

// The part of the ray that takes part, cut; where lenses overlap the later one rules. Neighbours differ in
// appearance. What is shorter than 1e-9 mm belongs to its neighbour.
std::vector<LensPart> cutAtLenses(const VolumeRay&, const std::vector<PlacedLens>&);

// The ray with that part alone, and all its tools.
VolumeRay partOf(const VolumeRay&, const LensPart&);
// Of a part, what lies between two distances, without tools.
VolumeRay bareBetween(const VolumeRay& part, double from_mm, double to_mm);

}  // namespace vernier::quality
