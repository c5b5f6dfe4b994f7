// SPDX-License-Identifier: GPL-3.0-or-later
// The surface techniques. registerSurfaces adds to the host:
//   surface.native  triangle surfaces by the rasteriser of module native, without GL     (kind surface)
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::surfaces {
Result<void> registerSurfaces(Host&);
}
