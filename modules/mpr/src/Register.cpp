// SPDX-License-Identifier: GPL-3.0-or-later
#include "SliceParams.h"
#include "vernier/mpr/Mpr.h"

namespace vernier::mpr {

Result<void> registerMpr(Host& host) {
  for (Technique t : {nativeImageTechnique(), nativeSliceTechnique(), slabExactTechnique(), curvedTechnique(),
                      stripsTechnique(host), polygonTechnique(host)})
    if (Result<void> r = host.addTechnique(std::move(t)); !r) return r;
  return {};
}

}  // namespace vernier::mpr
