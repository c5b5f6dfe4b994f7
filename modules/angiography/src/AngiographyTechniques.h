// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::angiography {
Technique sampledProjectionTechnique(Host&);
Technique exactProjectionTechnique(Host&);
}  // namespace vernier::angiography
