// SPDX-License-Identifier: GPL-3.0-or-later
// Settings of the program: flag > VERNIER_* > $XDG_CONFIG_HOME/vernier/config.json > default. `vernier
// doctor` prints each value with its source.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vernier/base/Result.h"

namespace vernier::app {

struct Setting {
  std::string name;  // "threads"
  std::string value;
  std::string source;  // "flag", "VERNIER_THREADS", "config.json", "default"
};

struct Settings {
  int threads = 0;                         // 0 = all cores
  std::uint64_t memory_mb = 0;             // 0 = half of what is free
  std::string engine = "auto";             // auto | gl | native
  std::vector<std::string> pluginFolders;  // besides the install folder
  bool noticeSeen = false;                 // the notice of the first start was read
  std::vector<Setting> sources;            // one per setting, for doctor
};

// What flags gave; empty = not given.
struct SettingFlags {
  std::optional<int> threads;
  std::optional<std::string> engine;
  std::vector<std::string> pluginFolders;
};

// OptionInvalid names the setting and where its bad value stands.
Result<Settings> readSettings(const SettingFlags&);

// Can settings be kept? WriteFailed, with a sentence for the user, when the folder of config.json (or, while
// it does not exist, the nearest one above it) cannot be written. Nothing is created. Vernier works without
// it.
Result<void> checkSettingsFolder();

// Writes notice_seen into the settings file, which keeps all else that it holds. WriteFailed where that
// cannot be done.
Result<void> rememberNoticeSeen();

}  // namespace vernier::app
