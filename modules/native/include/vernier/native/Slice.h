// SPDX-License-Identifier: GPL-3.0-or-later
// Slices and slabs of a volume on the CPU, without GL. Trilinear or nearest, as GridGeometry.h defines the
// grid: true slice positions, gaps, the border held for half a voxel, no-data renormalised over valid
// corners.
//
// Accuracy: voxel positions are exact to 2^-24 of a voxel, interpolation is in float relative to the window's
// centre (fast kernel: even grids of U8, U16, I16 and F32) or in double (general kernel: all
// else); both stay far below 1e-4 of the local range of voxel values (RENDERING 3, Slices). Frames: Pixel
// (centres at half-integers, row 0 on top) to Patient mm by SlicePicture, to Voxel by the volume. Threads:
// tiles by parallelFor; every pixel depends on its own position alone, so the picture is bit-equal for any
// number of threads. The stop token is read once per row of a tile.
// Errors: Cancelled; Internal when the images do not have the size that the job asks for.
#pragma once
#include <stop_token>

#include "vernier/plan/PictureGeometry.h"
#include "vernier/plan/Scene.h"
#include "vernier/volume/Volume.h"

namespace vernier::native {

struct SliceJob {
  const Volume* volume = nullptr;
  SlicePicture picture;
  int width_px = 0, height_px = 0;
  Interpolation interpolation = Interpolation::Linear;
  // Sample k of n lies (k + 0.5) * thickness / n - thickness / 2 from the plane, along its normal. Samples
  // without data are left out; a mean is over those with data.
  Slab slab;
  int slabSamples = 1;
  VoiWindow window;  // usable and normalised (Voi.h)
  bool invert = false;
  Rgb background;  // where there is no data
};

// Fills colour, depth (0 where there is data, else kNothing_mm) and, when they have been allocated, values;
// writes every pixel, so nothing needs to be cleared before. Adds to counters.samples the positions that lay
// in the volume.
VERNIER_API Result<void> drawSlice(const SliceJob&, Images&, std::stop_token = {});

// True when the fast kernel will draw the job; for cost models and tests.
VERNIER_API bool drawsFast(const SliceJob&);

}  // namespace vernier::native
