// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/mpr/Mpr.h"
#include "vernier/plan/Plugin.h"

VERNIER_PLUGIN(vernier::mpr::registerMpr)
