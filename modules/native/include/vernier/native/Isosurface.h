// SPDX-License-Identifier: GPL-3.0-or-later
// Iso-surfaces on the CPU, without GL: the first point of each ray where the trilinear field reaches the
// level, lit (IsosurfaceLayer and Material in Scene.h), with the tools that stand in the volume.
//
// Even grids of one rescale with data in every voxel: cell by cell in double, the first root of each cell's
// cubic, so that nothing is stepped over and no step matters. Else (uneven slices, gaps, no-data): samples
// every step_mm, then bisection between two of them; no-data is neither inside nor outside, and what lies
// behind it begins anew.
// A ray whose part begins where the field has reached the level shows that place as a face turned to the eye.
//
// Frames: Pixel (centres at half-integers, row 0 on top), rays in patient mm by CameraPicture. Threads: tiles
// by parallelFor: bit-equal for any number of threads. The stop token is read once per row of packets.
// Errors: Cancelled; Internal for a job without a grey volume.
#pragma once
#include "vernier/native/VolumeRender.h"

namespace vernier::native {

struct IsosurfaceJob {
  const Volume* volume = nullptr;           // grey
  const VisibleBricks* reaching = nullptr;  // bricksReaching(level); null: nothing is left out
  CameraPicture camera;
  std::vector<HalfSpace> region;  // keptRegion()
  double level = 0;               // modality value
  Material material;
  std::vector<Light> lights;  // none: a white one at the eye
  double step_mm = 1;         // of bins, and of samples where there are any
  Rgb background;
  const SurfaceHits* tools = nullptr;  // of the same camera; null: none
  RaysOfPass rays;                     // where the images have rays that are cut at lenses: VolumeRender.h
};

// True when cells are walked.
VERNIER_API bool findsExactly(const IsosurfaceJob&);

// Fills colour and depth (of the surface, or of the tool that ends the ray before it; kNothing_mm without
// either). Writes every pixel. Adds samples and cells to the counters.
VERNIER_API Result<void> drawIsosurface(const IsosurfaceJob&, Images&, std::stop_token = {});

}  // namespace vernier::native
