// SPDX-License-Identifier: GPL-3.0-or-later
// What tells whether an edge of the picture runs between two pixels: what their rays have in common (a key),
// and the sharp surfaces that they see: where one sees a surface and the other does not, or the distances to
// it differ by much more than its slope explains.
#pragma once
#include <cstdint>
#include <vector>

#include "RayCamera.h"

namespace vernier::quality {

struct EdgeMark {
  // What a surface must leave of a pixel to be asked for in the other, and what it is there found with: a
  // surface that fades from view makes no edge.
  static constexpr double kSeen = 0.1, kFound = 0.02;

  std::uint64_t key = 0;
  struct Hit {
    std::size_t surface = 0;
    double t_mm = 0;
    glm::dvec3 normal{0};  // patient, unit; 0: unknown
    double left = 1;       // of light from there
  };
  std::vector<Hit> hits;  // nearest first
  PixelRay line;
  double voxel_mm = 0;  // the largest spacing, within which a trilinear surface may bend as it likes
};

bool edgeBetween(const EdgeMark&, const EdgeMark&);

}  // namespace vernier::quality
