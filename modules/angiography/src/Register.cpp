// SPDX-License-Identifier: GPL-3.0-or-later
#include "AngiographyTechniques.h"
#include "ShellParams.h"
#include "vernier/angiography/Angiography.h"

namespace vernier::angiography {

Result<void> registerAngiography(Host& host) {
  const auto store = std::make_shared<ShellStore>(host);
  for (Technique t :
       {sampledProjectionTechnique(host), exactProjectionTechnique(host), glProjectionTechnique(host),
        nativeShellsTechnique(store), glShellsTechnique(host, store), glMaxShellsTechnique(host, store)})
    if (Result<void> r = host.addTechnique(std::move(t)); !r) return r;
  return {};
}

}  // namespace vernier::angiography
