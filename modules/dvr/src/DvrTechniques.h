// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::dvr {

Technique nativeVolumeTechnique(Host&);      // NativeVolume.cpp
Technique nativeIsosurfaceTechnique(Host&);  // NativeIsosurface.cpp

}  // namespace vernier::dvr
