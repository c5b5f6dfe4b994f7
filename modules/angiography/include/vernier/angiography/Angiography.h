// SPDX-License-Identifier: GPL-3.0-or-later
// Looking through a volume. registerAngiography adds to the host:
//   projection.native  what a ray amounts to, sampled along it: SIMD           (kind projection)
//   projection.exact   the same without sampling error, cell by cell in double (kind projection)
//   shells.native      emission shells by rays through their meshes            (kind shells)
//   shells.gl          GL: the depth buffer is the maximum operator, Heidrich et al. 1996, section 3 (kind
//   shells) shells.glmax       GL: blending by GL_MAX on a float target                (kind shells)
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::angiography {
Result<void> registerAngiography(Host&);
}
