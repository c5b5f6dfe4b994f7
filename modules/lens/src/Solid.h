// SPDX-License-Identifier: GPL-3.0-or-later
// A convex body in the lens's own frame, mm: what is cached, whatever the pose.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vernier/base/ConvexRegion.h"
#include "vernier/plan/Scene.h"

namespace vernier::lens {

struct Solid {
  std::vector<glm::dvec3> corners;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // closed, counterclockwise from outside
  std::vector<std::uint32_t> planeOf;                   // the facet of each triangle
  std::vector<glm::dvec3> normals;                      // of the facets, outward, unit
  std::string notice;                                   // what was left out of the shape; "": nothing
  std::uint64_t bytes() const;
};

inline Error shapeFault(std::string sentence) {
  return makeError(ErrorCode::SceneInvalid, std::move(sentence));
}

// The solid where the pose puts it. Normals go by the inverse transpose; offsets are such that each facet
// holds all corners of its triangles, bit by bit. A pose that mirrors turns the triangles over. SceneInvalid
// when the pose squeezes by more than 1:100000, or brings the lens so far away or makes it so small that
// double cannot tell its corners apart.
Result<ConvexRegion> placed(const Solid&, const PatientFromMesh&);

}  // namespace vernier::lens
