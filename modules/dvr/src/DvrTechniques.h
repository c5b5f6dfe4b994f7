// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::dvr {

Technique glRaysTechnique(Host&);  // GlRays.cpp

}  // namespace vernier::dvr
