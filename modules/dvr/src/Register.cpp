// SPDX-License-Identifier: GPL-3.0-or-later
#include "DvrTechniques.h"
#include "vernier/dvr/Dvr.h"

namespace vernier::dvr {

Result<void> registerDvr(Host&) { return {}; }

}  // namespace vernier::dvr
