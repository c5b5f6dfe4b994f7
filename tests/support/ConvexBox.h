// SPDX-License-Identifier: GPL-3.0-or-later
// Convex regions made by hand, for tests that need no module of shapes.
#pragma once
#include <memory>

#include "vernier/base/ConvexRegion.h"

namespace vernier::test {

// A box along the patient's axes: six planes, eight corners, twelve triangles.
inline std::shared_ptr<const ConvexRegion> boxRegion(glm::dvec3 least, glm::dvec3 most) {
  auto r = std::make_shared<ConvexRegion>();
  for (int n = 0; n < 8; ++n)
    r->corners.emplace_back(n & 1 ? most.x : least.x, n & 2 ? most.y : least.y, n & 4 ? most.z : least.z);
  const auto face = [&](glm::dvec3 normal, double offset_mm, std::array<std::uint32_t, 4> around) {
    const auto plane = static_cast<std::uint32_t>(r->planes.size());
    r->planes.push_back({PatientVec(normal), offset_mm});
    r->triangles.push_back({around[0], around[1], around[2]});
    r->triangles.push_back({around[0], around[2], around[3]});
    r->planeOf.insert(r->planeOf.end(), {plane, plane});
  };
  face({-1, 0, 0}, -least.x, {0, 4, 6, 2});
  face({1, 0, 0}, most.x, {1, 3, 7, 5});
  face({0, -1, 0}, -least.y, {0, 1, 5, 4});
  face({0, 1, 0}, most.y, {2, 6, 7, 3});
  face({0, 0, -1}, -least.z, {0, 2, 3, 1});
  face({0, 0, 1}, most.z, {4, 5, 7, 6});
  return r;
}

}  // namespace vernier::test
