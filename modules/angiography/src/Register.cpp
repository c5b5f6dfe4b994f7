// SPDX-License-Identifier: GPL-3.0-or-later
#include "AngiographyTechniques.h"
#include "vernier/angiography/Angiography.h"

namespace vernier::angiography {

Result<void> registerAngiography(Host& host) {
  for (Technique t : {sampledProjectionTechnique(host), exactProjectionTechnique(host)})
    if (Result<void> r = host.addTechnique(std::move(t)); !r) return r;
  return {};
}

}  // namespace vernier::angiography
