// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Plugin.h"
#include "vernier/mpr/Mpr.h"

VERNIER_PLUGIN(vernier::mpr::registerMpr)
