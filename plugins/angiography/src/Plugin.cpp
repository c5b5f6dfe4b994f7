// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Plugin.h"
#include "vernier/angiography/Angiography.h"

VERNIER_PLUGIN(vernier::angiography::registerAngiography)
