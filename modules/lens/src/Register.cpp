// SPDX-License-Identifier: GPL-3.0-or-later
#include "LensTechniques.h"
#include "vernier/lens/Lens.h"

namespace vernier::lens {

Result<void> registerLens(Host& host) { return host.addTechnique(nativeLensTechnique(host)); }

}  // namespace vernier::lens
