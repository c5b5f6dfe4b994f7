// SPDX-License-Identifier: GPL-3.0-or-later
// Volume rendering: emission and absorption along rays, extremes, iso-surfaces. registerDvr adds the
// techniques to the host.
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::dvr {
Result<void> registerDvr(Host&);
}
