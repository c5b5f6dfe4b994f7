// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::dvr {

Technique nativeVolumeTechnique(Host&);      // NativeVolume.cpp
Technique nativeIsosurfaceTechnique(Host&);  // NativeIsosurface.cpp
Technique glRaysTechnique(Host&);            // GlRays.cpp

// GlStacks.cpp
Technique glStacksTechnique(Host&);
Technique glStacks2Technique(Host&);
Technique glStacks4Technique(Host&);
Technique glUncorrectedStacksTechnique(Host&);

Technique glCombinedTechnique(Host&);  // GlCombined.cpp

// GlSlabs.cpp
Technique glSlabsTechnique(Host&);
Technique glStripsTechnique(Host&);

}  // namespace vernier::dvr
