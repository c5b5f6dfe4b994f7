// SPDX-License-Identifier: GPL-3.0-or-later
// Where the voxels of a stack lie in the patient. Shared by study (which fits it), volume and everything that
// samples.
//
// patientFromVoxel maps Voxel (column i, row j, slice k; centres at integers) to Patient mm; it may be
// oblique, sheared (gantry tilt) and left-handed. When the slices don't lie on that even lattice,
// sliceOrigin_vox holds the true origin of each slice in the Voxel frame of that map: slice s covers points
// (i + origin.x, j + origin.y, origin.z), with origin.z strictly ascending and origin.z == s on an even
// lattice. Between two slices the value is interpolated linearly in k, each slice being sampled at (i -
// origin.x, j - origin.y). gapAfter lists slices s after which slices are missing: between s and s + 1
// nothing is interpolated; a slice is held for half a step (0.5 in k) on the side of a gap or at the stack's
// ends, beyond is no-data. In the plane of a slice the border is half a voxel, likewise held.
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "vernier/base/Frames.h"

namespace vernier {

struct GridGeometry {
  std::int64_t columns = 0, rows = 0, slices = 0;
  PatientFromVoxel patientFromVoxel;
  std::vector<glm::dvec3> sliceOrigin_vox;  // empty: even lattice; else one per slice
  std::vector<std::int64_t> gapAfter;       // ascending; only with sliceOrigin_vox

  bool even() const { return sliceOrigin_vox.empty(); }
  // Distance between neighbouring columns, rows, and slice planes along the normal, mm.
  glm::dvec3 spacing_mm() const {
    const glm::dmat3& m = patientFromVoxel.linear;
    const glm::dvec3 n = glm::normalize(glm::cross(m[0], m[1]));
    return {glm::length(m[0]), glm::length(m[1]), std::abs(glm::dot(m[2], n))};
  }
  double firstPosition_vox() const { return even() ? 0.0 : sliceOrigin_vox.front().z; }
  double lastPosition_vox() const {
    return even() ? static_cast<double>(slices - 1) : sliceOrigin_vox.back().z;
  }
  // Corner n (0..7: bit 0 = last column, bit 1 = last row, bit 2 = last slice) of the box of voxel centres.
  PatientPoint corner(int n) const {
    return patientFromVoxel * VoxelPoint(n & 1 ? static_cast<double>(columns - 1) : 0.0,
                                         n & 2 ? static_cast<double>(rows - 1) : 0.0,
                                         n & 4 ? lastPosition_vox() : firstPosition_vox());
  }
  PatientPoint centre() const { return Point<PatientFrame>((corner(0).p + corner(7).p) * 0.5); }
};

}  // namespace vernier
