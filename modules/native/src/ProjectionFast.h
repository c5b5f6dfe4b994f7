// SPDX-License-Identifier: GPL-3.0-or-later
// A projection job made ready for the SIMD kernel: even grids, one rescale, linear; U8, U16, I16 and F32.
//
// Lanes lie along the ray: 16 steps of the lattice are a block. Positions are double at a block's beginning
// and float from there. The kernel works in `score`, the stored value minus a whole `bias`, turned over where
// that makes the wanted extremum the greatest one.
#pragma once
#include <optional>

#include "ProjectionBounds.h"
#include "ProjectionRay.h"
#include "SliceFast.h"

namespace vernier::native {

struct FastProjection {
  const ProjectionJob* job = nullptr;
  FastSlice read;  // data, strides, bias
  float sign = 1;  // score = sign * w
  double slope = 1, intercept = 0;
  // Score of a bound in modality values: never below the score of what it bounds.
  float boundScale = 1, boundOffset = 0;
  const float* fine = nullptr;  // null: nothing is left out
  const float* coarse = nullptr;
  const float* holes = nullptr;
  std::int32_t fineSize[3] = {0, 0, 0}, coarseSize[3] = {0, 0, 0};
  float greyScale = 0, greyOffset = 0;  // of a score, before clamping
  double modalityOf(double score) const { return slope * (sign * score + read.bias) + intercept; }
};

std::optional<FastProjection> fastProjectionOf(const ProjectionJob&);

using FastKernel = void (*)(const FastProjection&, const VoxelRay&, const RayStretch&, RayHint&, Gathered&,
                            ProjectionWork&);
FastKernel fastKernelFor(const FastProjection&);

}  // namespace vernier::native
