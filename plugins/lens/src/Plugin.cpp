// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Plugin.h"
#include "vernier/lens/Lens.h"

VERNIER_PLUGIN(vernier::lens::registerLens)
