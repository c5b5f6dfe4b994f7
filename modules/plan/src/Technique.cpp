// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Technique.h"

#include <algorithm>

namespace vernier {

Result<void> TechniqueRegistry::add(Technique technique) {
  if (technique.name.empty() || technique.kinds.empty() || !technique.passesFor || !technique.execute)
    return makeError(ErrorCode::PluginFailed,
                     "A technique must have a name, layer kinds, a planner and an executor; '" +
                         technique.name + "' lacks one; mend the plugin that brings it.",
                     technique.name);
  if (find(technique.name))
    return makeError(
        ErrorCode::PluginFailed,
        "The technique '" + technique.name + "' is registered already; remove one of the two plugins.",
        technique.name);
  techniques_.push_back(std::move(technique));
  return {};
}

const Technique* TechniqueRegistry::find(const std::string& name) const {
  for (const Technique& t : techniques_)
    if (t.name == name) return &t;
  return nullptr;
}

std::vector<const Technique*> TechniqueRegistry::drawing(const std::string& kind) const {
  std::vector<const Technique*> found;
  for (const Technique& t : techniques_)
    if (std::find(t.kinds.begin(), t.kinds.end(), kind) != t.kinds.end()) found.push_back(&t);
  return found;
}

Result<void> Host::addPanel(Panel) { return {}; }

DerivedCache& Host::derivedData() { return own_; }

}  // namespace vernier
