// SPDX-License-Identifier: GPL-3.0-or-later
// The geometry of Rezk-Salama et al. 2000, section 9, in double: the cross-section of the slicing plane with
// the volume's box, cut at the texture slices into strips. The plane is given by its picture, so a polygon is
// a list of picture coordinates (pixels, row 0 on top), and every face of the box and every slice is a line
// there.
//
// Strips are always cut along k, the volume's own slices: these are stored as textures need them, and only
// they keep the true positions of uneven stacks, where a strip simply spans the distance that there is. (The
// paper keeps three copies of the volume and takes the axis nearest to the view; for single slices the axis
// only changes the number of strips, not the picture.)
#pragma once
#include <vector>

#include "vernier/base/GridGeometry.h"

namespace vernier::mpr {

// voxel = origin + x * right + y * down, x and y in pixels.
struct VoxelPlane {
  glm::dvec3 origin{0}, right{0}, down{0};
  glm::dvec3 at(glm::dvec2 picture_px) const { return origin + picture_px.x * right + picture_px.y * down; }
};

// A part of the stack along k: between two neighbouring slices, or where one slice is held (first == second)
// for half a step at the stack's ends and beside gaps.
struct StackPart {
  std::int64_t first = 0, second = 0;
  double lower = 0, upper = 0;
};
std::vector<StackPart> partsOf(const GridGeometry&);  // ascending in k; across a gap there is none

// How much wider than the truth outlines are cut, so that rounding cannot leave a hole: a fragment shader
// that knows its exact position drops what is too much. Zero where the rasteriser alone decides.
struct Margin {
  double px = 0, vox = 0;
};

using Outline = std::vector<glm::dvec2>;  // a convex polygon; empty: nothing

double areaOf(const Outline&);  // square pixels

// The plane within the picture and the volume's box with its border of half a voxel, all widened by the
// margin.
Outline crossSection(const VoxelPlane&, const GridGeometry&, int width_px, int height_px, Margin);

struct Strip {
  StackPart part;
  VoxelPlane plane;
  Outline outline;
};
// The strips of one plane, only those that are there. A plane that lies in a slice within 1e-6 voxel is one
// strip of that slice alone.
std::vector<Strip> cutIntoStrips(const VoxelPlane&, const GridGeometry&, int width_px, int height_px, Margin);

}  // namespace vernier::mpr
