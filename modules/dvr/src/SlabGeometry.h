// SPDX-License-Identifier: GPL-3.0-or-later
// View-aligned slices through slabs of a volume (SGI, Volume Rendering Primer): how many slices a slab has,
// in which order slabs are met, and the polygons of the slices inside them. Pure functions in double.
#pragma once
#include <optional>
#include <vector>

#include "StackGeometry.h"

namespace vernier::dvr {

// Slices first .. first + count - 1 of the volume; neighbours share one. Places from `from` on, below `below`
// along z belong to it; those beyond the volume to the outermost.
struct Slab {
  std::int64_t first = 0, count = 0;
  double from = 0, below = 0;
};
// Slices of a slab that the budget holds, at most `most`; nullopt where it does not hold two. All slices
// where they fit.
std::optional<std::int64_t> slabSize(std::int64_t slices, std::uint64_t bytesOfSlice, std::uint64_t budget,
                                     std::int64_t most);
// Of slabs of `size` slices (at least 2), nearest first: every ray meets them in this order.
std::vector<Slab> slabsOf(std::int64_t slices, std::int64_t size, const CameraPicture&,
                          const VoxelFromPatient&);

// A convex body between two depths: the corners of `least` .. `greatest` (voxels) within [from_mm, to_mm]
// along the view, and where its edges pass through these depths.
std::vector<glm::dvec3> bodyBetween(glm::dvec3 least, glm::dvec3 greatest, double from_mm, double to_mm,
                                    const CameraPicture&, const PatientFromVoxel&);
// Depths of the box's corners.
glm::dvec2 depthsOf(glm::dvec3 least, glm::dvec3 greatest, const CameraPicture&, const PatientFromVoxel&);
// Of points in voxels what is seen in the picture, a pixel wider, convex; the whole picture where one lies
// beside or behind the eye. Empty: nothing.
Outline outlineOf(const std::vector<glm::dvec3>& points, const CameraPicture&, const PatientFromVoxel&,
                  double margin_px = 1);

}  // namespace vernier::dvr
