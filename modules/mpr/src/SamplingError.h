// SPDX-License-Identifier: GPL-3.0-or-later
// What the midpoint samples of a slab miss, for all techniques that sample.
#pragma once
#include "SliceParams.h"

namespace vernier::mpr {

// Levels of 255. Measured at step 1, the largest 99 % bound of oblique slabs of 10 mm: extrema 22 (CT head
// phantom, 0.8 mm slices, bone window), 37 (CT head, 5 mm, window 400), 36 (vessels, window 600); means 0.5,
// 1.5 and 0.7. For extrema it halves with the step: what is missed at peaks and at the slab's ends is in
// proportion to it.
inline double samplingError(const SampledParams& p, double step) {
  if (!(p.slab.thickness_mm > 0)) return 0;
  return (p.slab.mode == SlabMode::Mean ? 1.5 : 37.0) * step;
}

}  // namespace vernier::mpr
