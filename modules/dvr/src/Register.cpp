// SPDX-License-Identifier: GPL-3.0-or-later
#include "DvrTechniques.h"
#include "vernier/dvr/Dvr.h"

namespace vernier::dvr {

Result<void> registerDvr(Host& host) {
  for (Technique (*make)(Host&) :
       {nativeVolumeTechnique, nativeIsosurfaceTechnique, glRaysTechnique, glStacksTechnique,
        glStacks2Technique, glStacks4Technique, glUncorrectedStacksTechnique, glCombinedTechnique,
        glSlabsTechnique, glStripsTechnique})
    if (Result<void> added = host.addTechnique(make(host)); !added) return added;
  return {};
}

}  // namespace vernier::dvr
