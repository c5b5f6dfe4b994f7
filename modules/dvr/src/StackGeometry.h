// SPDX-License-Identifier: GPL-3.0-or-later
// Object-aligned stacks of slices (Rezk-Salama 2000, sections 4 to 6): which axis they lie across, where the
// slices and those between them stand, and the polygons that show them. Pure functions in double.
#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "vernier/plan/CameraPicture.h"

namespace vernier::dvr {

// Across the axis (0 columns, 1 rows, 2 slices) that the view is nearest to: it changes at 45 degrees.
int stackAxis(const CameraPicture&, const GridGeometry&);
// Slices for each voxel along the axis: 1, 2, 4 or 8, at least 1 / step.
int slicesPerVoxel(double step);

struct StackSlice {
  double place = 0;        // along the axis, voxels
  std::int64_t lower = 0;  // the textures that it lies between; alpha 0: in `lower`
  double alpha = 0;
};
// S_i+alpha for all i and alpha = 0, 1 / perVoxel ..., ascending.
std::vector<StackSlice> stackSlices(std::int64_t count, int perVoxel);

// Neighbouring slices on one polygon. `first` .. `first + count - 1` of stackSlices().
struct StackPolygon {
  std::size_t first = 0, count = 0;
};
// Nearest to the eye first: in perspective by the distance from the eye to both sides, so that every ray
// meets them in this order.
std::vector<StackPolygon> stackPolygons(const std::vector<StackSlice>&, std::size_t perPolygon, int axis,
                                        const CameraPicture&, const VoxelFromPatient&);

using Outline = std::vector<glm::dvec2>;  // in pixels

}  // namespace vernier::dvr
