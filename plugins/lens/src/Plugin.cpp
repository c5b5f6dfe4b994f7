// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/lens/Lens.h"
#include "vernier/plan/Plugin.h"

VERNIER_PLUGIN(vernier::lens::registerLens)
