// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Plugin.h"
#include "vernier/dvr/Dvr.h"

VERNIER_PLUGIN(vernier::dvr::registerDvr)
