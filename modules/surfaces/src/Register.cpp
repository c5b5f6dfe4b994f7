// SPDX-License-Identifier: GPL-3.0-or-later
#include "SurfaceTechniques.h"
#include "vernier/surfaces/Surfaces.h"

namespace vernier::surfaces {

Result<void> registerSurfaces(Host& host) { return host.addTechnique(nativeSurfaceTechnique()); }

}  // namespace vernier::surfaces
