// SPDX-License-Identifier: GPL-3.0-or-later
#include "EdgeMark.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier::quality {
namespace {

using Hit = EdgeMark::Hit;

// By how much the plane through the hit lies farther off, or nearer, on the other ray.
double explained(const Hit& hit, const PixelRay& line, const PixelRay& other) {
  if (hit.normal == glm::dvec3(0)) return 0;
  const double slope = glm::dot(hit.normal, other.direction);
  if (std::abs(slope) < 1e-9) return std::numeric_limits<double>::infinity();
  return std::abs(glm::dot(hit.normal, line.at(hit.t_mm) - other.origin) / slope - hit.t_mm);
}

bool oneSurface(const Hit& a, const PixelRay& lineA, const Hit& b, const PixelRay& lineB, double voxel_mm) {
  if (a.surface != b.surface) return false;
  const double slope = std::min(explained(a, lineA, lineB), explained(b, lineB, lineA));
  const double pixel_mm = glm::length(lineA.at(a.t_mm) - lineB.at(a.t_mm));
  return std::abs(a.t_mm - b.t_mm) <= 2 * slope + pixel_mm + voxel_mm;
}

bool allFound(const EdgeMark& a, const EdgeMark& b) {
  for (std::size_t n = 0; n < a.hits.size() && a.hits[n].left >= EdgeMark::kSeen; ++n)
    if (n >= b.hits.size() || !oneSurface(a.hits[n], a.line, b.hits[n], b.line, a.voxel_mm)) return false;
  return true;
}

}  // namespace

bool edgeBetween(const EdgeMark& a, const EdgeMark& b) {
  return a.key != b.key || !allFound(a, b) || !allFound(b, a);
}

}  // namespace vernier::quality
