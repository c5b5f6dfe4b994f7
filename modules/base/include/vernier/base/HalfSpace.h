// SPDX-License-Identifier: GPL-3.0-or-later
// A closed half-space in patient mm: the points p with dot(normal, p) <= offset_mm. The normal is a unit
// vector that points out of the half-space.
#pragma once
#include "vernier/base/Frames.h"

namespace vernier {

struct HalfSpace {
  PatientVec normal{0, 0, 1};
  double offset_mm = 0;
  double distance_mm(PatientPoint p) const { return glm::dot(normal.v, p.p) - offset_mm; }  // > 0 outside
  bool contains(PatientPoint p) const { return distance_mm(p) <= 0; }
  friend bool operator==(const HalfSpace&, const HalfSpace&) = default;
};

}  // namespace vernier
