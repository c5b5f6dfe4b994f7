// SPDX-License-Identifier: GPL-3.0-or-later
// A closed convex part of the patient with faces: what a lens is to everyone but the module that builds it.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vernier/base/HalfSpace.h"

namespace vernier {

struct ConvexRegion {
  // One per facet, no two the same; unit normals outward, offsets in mm, double. A point belongs to the
  // region when it lies in all of them (faces, edges and corners too).
  std::vector<HalfSpace> planes;
  // The surface: closed, counterclockwise from outside, mm. Corners lie on their planes to rounding.
  std::vector<PatientPoint> corners;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> planeOf;  // the plane of each triangle
  // What its maker left out of the shape that was asked for, to be said with the plan; "": nothing.
  std::string notice;

  bool contains(PatientPoint p) const {
    for (const HalfSpace& h : planes)
      if (!h.contains(p)) return false;
    return true;
  }
};

}  // namespace vernier
