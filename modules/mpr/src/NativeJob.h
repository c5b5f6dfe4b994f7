// SPDX-License-Identifier: GPL-3.0-or-later
// A slice pass as a job for module native.
#pragma once
#include "SliceParams.h"
#include "vernier/native/Slice.h"

namespace vernier::mpr {

inline native::SliceJob jobOf(const SliceParams& p) {
  native::SliceJob job;
  job.volume = p.volume.get();
  job.picture = p.picture;
  job.width_px = p.view.width_px;
  job.height_px = p.view.height_px;
  job.interpolation = p.interpolation;
  job.slab = p.slab;
  job.slabSamples = p.slabSamples;
  job.window = p.window;
  job.invert = p.invert;
  job.background = p.background;
  return job;
}

// Of one sample on one thread, measured.
double builtInCost_ns(Interpolation, bool fast);

// Levels of 255 that rounding to float makes of a modality value.
double roundingError(const SampledParams&);

}  // namespace vernier::mpr
