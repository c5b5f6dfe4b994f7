// SPDX-License-Identifier: GPL-3.0-or-later
#include "AngiographyTechniques.h"
#include "vernier/angiography/Angiography.h"

namespace vernier::angiography {

Result<void> registerAngiography(Host& host) { return host.addTechnique(nativeProjectionTechnique()); }

}  // namespace vernier::angiography
