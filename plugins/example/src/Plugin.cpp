// SPDX-License-Identifier: GPL-3.0-or-later
// What the program calls when it loads the plugin: everything is registered, or nothing is.
#include "vernier/plan/Plugin.h"
#include "ValueBand.h"

namespace {
vernier::Result<void> registerExample(vernier::Host& host) {
  if (vernier::Result<void> r = host.addTechnique(example::bandTechnique()); !r) return r;
  return host.addPanel(example::bandPanel());
}
}  // namespace

VERNIER_PLUGIN(registerExample)
