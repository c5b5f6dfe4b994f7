// SPDX-License-Identifier: GPL-3.0-or-later
// Looking through a volume. registerAngiography adds to the host:
//   projection.native  what a ray amounts to, sampled along it: SIMD        (kind projection)
//   projection.exact   the same without sampling error, cell by cell in double (kind projection)
//   projection.gl      sampled on a 3-D texture of OpenGL                   (kind projection)
//   shells.native      emission shells by the native rasteriser               (kind shells)
//   shells.gl          the same, the depth buffer as maximum
//   shells.glmax       the same, blending as maximum
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::angiography {
Result<void> registerAngiography(Host&);
}
