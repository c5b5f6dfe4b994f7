// SPDX-License-Identifier: GPL-3.0-or-later
// What differs between two volumes, slice by slice of the first. Modality values in double from stored
// voxels: never a texture, never an image library's resampling. B is read at the voxel centres of A, moved by
// `offset`; where both lie on the same lattice that is voxel against voxel, exactly (identical volumes give
// exactly 0), else trilinear (volume/Sampling.h) and said so. Voxels that only one of them has data for are
// counted, not compared. Who may be compared with whom is for the caller to know. OptionInvalid: colour
// volumes, other units. Thread-safe.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "vernier/volume/Volume.h"

namespace vernier::measure {

struct VoxelDifference {
  std::uint64_t compared = 0, unmatched = 0;
  double max = 0, mean = 0, rmse = 0;  // of absolute differences
  double bias = 0;                     // mean of b - a
};
struct VolumeDifference {
  std::string unit;
  bool resampled = false;
  std::vector<VoxelDifference> slices;  // of a
  VoxelDifference all;
  std::int64_t worstSlice = 0;  // the first with the largest difference
};

VERNIER_API Result<VolumeDifference> compareVolumes(const Volume& a, const Volume& b,
                                                    PatientVec offset_mm = PatientVec(glm::dvec3(0)));

}  // namespace vernier::measure
