// SPDX-License-Identifier: GPL-3.0-or-later
#include "LensTechniques.h"
#include "vernier/lens/Lens.h"

namespace vernier::lens {

Result<void> registerLens(Host& host) {
  if (Result<void> r = host.addTechnique(nativeLensTechnique(host)); !r) return r;
  return host.addTechnique(glLensTechnique(host));
}

}  // namespace vernier::lens
