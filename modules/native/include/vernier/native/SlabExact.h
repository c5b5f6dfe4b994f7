// SPDX-License-Identifier: GPL-3.0-or-later
// Slabs without sampling error: maximum, minimum or mean of the trilinear field along each pixel's line.
//
// The line of a pixel runs through [-T/2, T/2] along the plane's normal, cut to the volume with its
// half-voxel border (GridGeometry.h). It is walked cell by cell; each face is met at its own parameter,
// computed from the face's integer, so nothing drifts. Inside a cell the field along a line is a cubic: its
// extrema are its ends and the roots of its derivative, its integral is Simpson's rule, exact for cubics. A
// cell whose eight corners cannot beat what was found is left out; a trilinear value never leaves the range
// of its corners. The mean is over the length inside the volume.
//
// Accuracy: double throughout, about 1e-11 of the local range; then rounded to float. Only even grids, linear
// interpolation, one rescale and no padding declared. Frames, threads, cancellation and errors: as
// Slice.h, and Internal for a job that whyNotExactSlab() names.
#pragma once
#include <string>

#include "vernier/native/Slice.h"

namespace vernier::native {

// One sentence why the job cannot be drawn exactly; "" when it can.
VERNIER_API std::string whyNotExactSlab(const SliceJob&);

// As drawSlice(); slabSamples is not looked at. Adds the cells walked to counters.cells and the evaluations
// of the field to counters.samples.
VERNIER_API Result<void> drawSlabExact(const SliceJob&, Images&, std::stop_token = {});

// The most cells that the line of one pixel can pass; for cost models.
VERNIER_API double cellsPerSlabLine(const SliceJob&);

}  // namespace vernier::native
