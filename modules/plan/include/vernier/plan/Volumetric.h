// SPDX-License-Identifier: GPL-3.0-or-later
// What all techniques that look through a volume share, so that their pictures mean the same: which part of
// the volume takes part, how a depth cue falls off, which levels a set of shells has, and the tools that
// stand in the picture. Pure functions in double. The reference (module quality) has its own.
#pragma once
#include <algorithm>
#include <vector>

#include "vernier/plan/CameraPicture.h"
#include "vernier/plan/RayIntervals.h"
#include "vernier/plan/Technique.h"
#include "vernier/volume/Volume.h"

namespace vernier {

// The closed region that takes part: the box of voxel centres (first and last slice at their true places),
// the scene's crop box and its clip planes. Six or more half-spaces, in that order; outer ones that say
// nothing new are kept. SceneInvalid, with the JSON path, for a crop box that is empty or not finite and for
// a plane without a direction; GeometryRefused for a volume of a single slice, row or column, which has no
// inside.
VERNIER_API Result<std::vector<HalfSpace>> keptRegion(const Scene&, const GridGeometry&);

// The part of a ray inside all half-spaces and beyond the camera's near distance.
VERNIER_API RaySpan spanOf(const PatientRay&, const std::vector<HalfSpace>&, double nearAlongRay_mm);

// z' of the depth cue, 1 at the near end and 0 at the far end of the volume's box of voxel centres as this
// camera sees it (never nearer than the camera's near distance, and in perspective than a thousandth of the
// far one). Orthographic: falls evenly with depth. Perspective: linear in the depth after projection, as a
// depth buffer has it (Heidrich, section 3); byDistance: evenly here too.
struct DepthRamp {
  double near_mm = 0, far_mm = 1;  // depths along the camera's forward axis, near < far
  bool afterProjection = false;
  double at(double depth_mm) const {
    const double z = afterProjection ? (near_mm * far_mm / depth_mm - near_mm) / (far_mm - near_mm)
                                     : (far_mm - depth_mm) / (far_mm - near_mm);
    return std::clamp(z, 0.0, 1.0);  // what stands between the eye and the near end has 1
  }
};
VERNIER_API DepthRamp depthRamp(const CameraPicture&, const GridGeometry&, bool byDistance = false);

// LINEAR_EXACT over all values of the volume: least value black, greatest white. One level of width 1 where
// all are equal.
VERNIER_API VoiWindow wholeRange(const Volume&);

// 4 / diagonal of the box of voxel centres: along the diagonal a full emission gives 4.
VERNIER_API double defaultGain_perMm(const GridGeometry&);

// The levels of the layer in modality values, ascending. The layer's window must be set. SceneInvalid, with
// the sentence: levels not finite or not ascending, none or more than kMostLevels, a window without width.
// Histogram reads every voxel (on all cores).
VERNIER_API Result<std::vector<double>> shellLevels(const ShellsLayer&, const Volume&);

// All surface layers of the scene, in its order. SceneInvalid, with the JSON path, for one that is not
// loaded, a pose that checkPose refuses, or an opacity outside 0..1.
VERNIER_API Result<std::vector<PlacedSurface>> placedSurfaces(const Scene&, const Sources&);

}  // namespace vernier
