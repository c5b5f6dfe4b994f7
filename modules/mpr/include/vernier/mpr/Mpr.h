// SPDX-License-Identifier: GPL-3.0-or-later
// The slice techniques. registerMpr adds to the host:
//   image.native  one stored frame, unresampled                     (kind image)
//   mpr.native    SIMD linear, cubic or nearest, slabs; reference grade            (kind slice)
//   mpr.exact     slabs without sampling error: the extrema and the integral of the field   (kind slice)
//   mpr.curved    curved planar reformats: the columns as lines through the volume, SIMD   (kind curved)
//   mpr.strips    GL: Gouraud-alpha polygon strips over a stack of 2-D textures, Rezk-Salama et al. 2000,
//   section 9 mpr.polygon   GL: one polygon on a 3-D texture
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::mpr {
Result<void> registerMpr(Host&);
}
