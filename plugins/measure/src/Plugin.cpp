// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Plugin.h"

namespace {
// Measurements are drawn over pictures, not into them: there is no layer to register (README.md).
vernier::Result<void> registerNothing(vernier::Host&) { return {}; }
}  // namespace

VERNIER_PLUGIN(registerNothing)
