// SPDX-License-Identifier: GPL-3.0-or-later
// From any points to the solid of their hull.
#pragma once
#include <span>

#include "Solid.h"

namespace vernier::lens {

// See Shapes.h for what is refused and what is left out.
Result<Solid> hullSolid(std::span<const MeshPoint> points);

// What counts as equal, for a set of points.
struct HullScale {
  glm::dvec3 middle{0};
  double half = 0;  // of the diagonal of the box, mm
  double flat = 0;  // nearer than this to a plane is in the plane: rounding of coordinates, mm
  double thin = 0;  // triangles thinner than this could turn over when rounded to float32, mm
};
HullScale hullScale(std::span<const glm::dvec3> points);

// The points that the hull needs, of at least four that have a volume: the others lie within `flat` of the
// hull of these. `seeds`: four of them with a volume.
Result<std::vector<glm::dvec3>> hullCandidates(std::span<const glm::dvec3> points, const HullScale&,
                                               const std::array<std::size_t, 4>& seeds);

// At most kMostHullPoints of the points: of each cell of a grid the one that stands farthest out.
std::vector<glm::dvec3> thinned(std::span<const glm::dvec3> points, const HullScale&);
// How far the farthest of the points stands outside the solid, at most; along the line from the middle.
double farthestOutside_mm(const Solid&, const glm::dvec3& middle, std::span<const glm::dvec3> points);

}  // namespace vernier::lens
