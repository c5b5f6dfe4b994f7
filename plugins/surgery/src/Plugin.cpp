// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Plugin.h"
#include "vernier/surfaces/Surfaces.h"

VERNIER_PLUGIN(vernier::surfaces::registerSurfaces)
