// SPDX-License-Identifier: GPL-3.0-or-later
// The convex hull by CGAL, in the one file that sees CGAL: EPICK, predicates exact, coordinates as given.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "vernier/base/Result.h"

namespace vernier::lens {

struct TriangleHull {
  std::vector<glm::dvec3> corners;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // closed, counterclockwise from outside
};

// Of finite points; empty when they lie in one plane exactly. Coplanar faces come in several triangles.
// Whatever CGAL throws is an Error.
Result<TriangleHull> exactHull(std::span<const glm::dvec3> points);

// The unit normal of the triangle, counterclockwise towards it, right to about 1e-14 however thin the
// triangle is; (0, 0, 0) for points that lie in a line.
glm::dvec3 exactNormal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

}  // namespace vernier::lens
