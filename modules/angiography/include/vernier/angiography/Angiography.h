// SPDX-License-Identifier: GPL-3.0-or-later
// Looking through a volume. registerAngiography adds to the host:
//   projection.native  what a ray amounts to, sampled along it: SIMD           (kind projection)
//   projection.exact   the same without sampling error, cell by cell in double (kind projection)
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::angiography {
Result<void> registerAngiography(Host&);
}
