// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/Affine.h"

#include <algorithm>
#include <cmath>

#include "GridCheck.h"

namespace vernier {
namespace {

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// The unit direction at right angles to two others; some direction when these are parallel or of no length.
glm::dvec3 normalOf(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 n = glm::cross(a, b);
  if (const double length = glm::length(n); length > 0 && std::isfinite(length)) return n / length;
  const glm::dvec3& any = glm::length(a) > 0 ? a : b;
  if (!(glm::length(any) > 0)) return {0, 0, 1};
  const glm::dvec3 least = std::abs(any.x) <= std::abs(any.y) && std::abs(any.x) <= std::abs(any.z)
                               ? glm::dvec3(1, 0, 0)
                           : std::abs(any.y) <= std::abs(any.z) ? glm::dvec3(0, 1, 0)
                                                                : glm::dvec3(0, 0, 1);
  return glm::normalize(glm::cross(any, least));
}

}  // namespace

PatientFromVoxel lpsFromRas(PatientFromVoxel m) {
  for (int axis = 0; axis < 3; ++axis) m.linear[axis] *= glm::dvec3(-1, -1, 1);
  m.translation *= glm::dvec3(-1, -1, 1);
  return m;
}

Result<void> settleAxes(GridGeometry& g) {
  glm::dmat3& m = g.patientFromVoxel.linear;
  if (!finite(m[0]) || !finite(m[1]) || !finite(m[2]) || !finite(g.patientFromVoxel.translation))
    return makeError(
        ErrorCode::GeometryRefused,
        "The affine holds a number that is not finite, so no voxel has a place; correct the header.");
  const std::int64_t sizes[] = {g.columns, g.rows, g.slices};
  for (int axis = 0; axis < 3; ++axis)
    if (sizes[axis] == 1 && glm::length(m[axis]) == 0)
      m[axis] = normalOf(m[(axis + 1) % 3], m[(axis + 2) % 3]);
  for (int axis = 0; axis < 3; ++axis)
    if (const double s = glm::length(m[axis]); !(s >= 1e-4 && s <= 1e3))
      return makeError(
          ErrorCode::GeometryRefused,
          "The distance of voxels must lie between 0.0001 and 1000 mm on each axis; correct the header.");
  return checkMap(g.patientFromVoxel);
}

Finding axesUnknown(const std::string& why) {
  return {"axes-unknown",
          Severity::Warning,
          why + " Lengths and angles hold, but left, right, front, back, head and foot are not known.",
          {}};
}

}  // namespace vernier
