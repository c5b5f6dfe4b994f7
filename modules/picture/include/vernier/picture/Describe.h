// SPDX-License-Identifier: GPL-3.0-or-later
// What a picture says about itself, from the scene's layer and the data behind it: letters from the displayed
// directions, "MPR axial 12/28", "MIP 10 mm", "coarse in z", missing slices, "bridged", gantry tilt, the
// window, the scale. The caller adds the error line (errorLine) to `status`, as its first line.
//
// "coarse in z" stands where slices at least kCoarseStep_mm apart are interpolated across: every view that is
// not parallel to them, and slabs. Slice numbers count from 1 here, as people do.
#pragma once
#include <span>

#include "vernier/picture/Annotate.h"
#include "vernier/plan/CameraPicture.h"
#include "vernier/plan/CurvedGeometry.h"
#include "vernier/volume/SurfaceFile.h"

namespace vernier {

inline constexpr double kCoarseStep_mm = 4.0;

// `window` is the one in use.
VERNIER_API Annotations describeSlice(const SliceLayer&, const SlicePicture&, const VolumeInfo&,
                                      const VoiWindow& window);
// "curved MPR, straightened"; letters only where they hold for the whole picture. The plan's notes say where
// a sheet overlaps itself.
VERNIER_API Annotations describeCurved(const CurvedLayer&, const CurvedPicture&, const VolumeInfo&,
                                       const VoiWindow& window);
VERNIER_API Annotations describeImage(const ImageLayer&, const ImagePicture&, const ImageFrameInfo&,
                                      const VoiWindow& window, const FramePresentation* = nullptr);
// Surfaces alone, in 3-D. Letters only where a patient was opened too: a surface file by itself has no sides.
// The scale stands on orthographic pictures only, since in perspective there is none.
VERNIER_API Annotations describeSurfaces(const CameraPicture&, std::span<const SurfaceFile* const>,
                                         bool withPatient);

// Looks through a volume; `window` is the one in use. "MIP, depth cue 0.5"; "12 emission shells, max", and
// that such a picture is no bound of the maximum. Cut by crop box or clip planes: said.
VERNIER_API Annotations describeProjection(const ProjectionLayer&, const CameraPicture&, const VolumeInfo&,
                                           const VoiWindow& window, bool cut);
VERNIER_API Annotations describeShells(const ShellsLayer&, const CameraPicture&, const VolumeInfo&,
                                       const VoiWindow& window, bool cut);

// "DVR, ct", "DVR, shaded", "volume maximum"; "iso-surface 300 HU".
VERNIER_API Annotations describeRendering(const VolumeLayer&, const CameraPicture&, const VolumeInfo&,
                                          bool cut);
VERNIER_API Annotations describeIsosurface(const IsosurfaceLayer&, const CameraPicture&, const VolumeInfo&,
                                           bool cut);

// "error <= 0.31 of 255 (99 %)", rounded up to two digits; amber when the bound is above the limit.
VERNIER_API TextLine errorLine(double bound, int confidence_percent, std::optional<double> limit = {});

}  // namespace vernier
