// SPDX-License-Identifier: GPL-3.0-or-later
// Finds, checks and loads plugins. Every plugin folder that was looked at ends in a named state; nothing is
// loaded that others may write, that was built otherwise, or whose card is damaged. Libraries are loaded
// RTLD_NOW | RTLD_LOCAL and never closed. Not thread-safe: load before rendering.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "vernier/plan/Technique.h"

namespace vernier::app {

enum class PluginState {
  Loaded,
  CardDamaged,        // plugin.json missing, not JSON, or without a needed key
  LibraryMissing,     // the card names a file that is not there
  WritableByOthers,   // folder, card or library may be written by others, or belongs to another user
  LoadFailed,         // the dynamic linker refused it
  NotAPlugin,         // one of the three entries is missing
  OtherAbi,           // built by another compiler, in another way, or against other headers
  OtherInterface,     // speaks another version of the plugin interface
  MissingDependency,  // needs a plugin that is not loaded
  Duplicate,          // another plugin has this name, or brings a technique or a panel that exists
  RegisterFailed,     // register() returned an error or threw
  Failed,             // threw while working; switched off
};
const char* nameOf(PluginState);

struct PluginInfo {
  std::string name;  // from the card; the folder's name when the card is damaged
  std::string version, description, folder;
  std::vector<std::string> kinds, views, needs;
  PluginState state = PluginState::CardDamaged;
  std::string reason;  // one sentence when not Loaded
  std::vector<std::string> techniques;
  std::vector<Panel> panels;
};

class PluginHost {
 public:
  // glDevice: how a technique gets the GL device of the render thread. derived: where techniques keep what
  // they derive from volumes; null: each plugin in a small place of its own. Outlives the host.
  explicit PluginHost(std::function<Result<gpu::Device*>()> glDevice, DerivedCache* derived = nullptr);
  ~PluginHost();

  // Looks at every sub-folder of `folders`, in order of names, dependencies first.
  void load(const std::vector<std::string>& folders);

  const std::vector<PluginInfo>& plugins() const;
  const TechniqueRegistry& techniques() const;
  // The panel of a layer kind, of a plugin that works; nullptr: none.
  const Panel* panelOf(const std::string& kind) const;

  // <program folder>/../lib/vernier/plugins
  static std::string installFolder();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vernier::app
