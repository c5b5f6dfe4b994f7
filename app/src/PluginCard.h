// SPDX-License-Identifier: GPL-3.0-or-later
// plugin.json: what a plugin says of itself, readable without loading it.
#pragma once
#include <string>
#include <vector>

#include "vernier/base/Result.h"

namespace vernier::app {

struct PluginCard {
  std::string name, version, interface, library, description;
  std::vector<std::string> kinds, views, needs;
};
// The sentence of an error says which key is wrong. `library` is a plain file name: no folder part.
Result<PluginCard> readPluginCard(const std::string& path);

}  // namespace vernier::app
