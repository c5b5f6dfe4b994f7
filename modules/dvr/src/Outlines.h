// SPDX-License-Identifier: GPL-3.0-or-later
// Outlines of slabs and slices over a finished picture, where a layer asks for them (SGI, Volume Rendering
// Primer: slabs dark blue, slices lighter and translucent). On the CPU, lines of 1.5 pixels.
#pragma once
#include <vector>

#include "SlabGeometry.h"
#include "vernier/plan/Frame.h"

namespace vernier::dvr {

struct LineColour {
  glm::dvec3 rgb{0};
  double opacity = 1;
};
inline constexpr LineColour kSlabLines{{0.1, 0.15, 0.6}, 1}, kSliceLines{{0.45, 0.6, 1}, 0.35};
inline const char* const kOutlinesNote =
    "outlines of slabs and slices are drawn into the picture, and its error is theirs too";

void drawOutline(Images&, const Outline&, const LineColour&);  // closed
// The twelve edges of a box of voxels.
void drawBox(Images&, glm::dvec3 least, glm::dvec3 greatest, const CameraPicture&, const PatientFromVoxel&);

}  // namespace vernier::dvr
