// SPDX-License-Identifier: GPL-3.0-or-later
// Curved planar reformats on the CPU: every column of pixels is a straight line in the patient and is drawn
// by the kernels of Slice.h, so their accuracy, no-data rules and interpolations hold here too.
//
// Frames: columns and rows of the picture by CurvedPicture. Threads: groups of columns by parallelFor; a
// column depends on itself alone, so the picture is bit-equal for any number of threads. The stop token is
// read once per column. Errors: Cancelled; Internal when the images or the columns do not have the size that
// the job asks for.
#pragma once
#include "vernier/native/Slice.h"
#include "vernier/plan/CurvedGeometry.h"

namespace vernier::native {

struct CurvedJob {
  const Volume* volume = nullptr;
  const CurvedPicture* picture = nullptr;
  int width_px = 0, height_px = 0;
  Interpolation interpolation = Interpolation::Linear;
  Slab slab;  // across the sheet, samples as in SliceJob
  int slabSamples = 1;
  VoiWindow window;
  bool invert = false;
  Rgb background;
};

// Fills the images as drawSlice() does; outside the sheet nothing is shown. Adds to counters.samples the
// positions that lay in the volume.
VERNIER_API Result<void> drawCurved(const CurvedJob&, Images&, std::stop_token = {});

// One column as a slice of one row; for cost models (drawsFast).
VERNIER_API SliceJob columnJob(const CurvedJob&, const CurvedColumn&);

}  // namespace vernier::native
