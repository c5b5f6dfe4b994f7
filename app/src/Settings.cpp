// SPDX-License-Identifier: GPL-3.0-or-later
#include "Settings.h"

#include <unistd.h>

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "vernier/picture/WriteFile.h"

namespace vernier::app {
namespace {
using nlohmann::json;

constexpr std::uintmax_t kMaxConfigBytes = 1 << 20;

std::string configPath() {
  if (const char* xdg = std::getenv("XDG_CONFIG_HOME"); xdg && *xdg)
    return std::string(xdg) + "/vernier/config.json";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::string(home) + "/.config/vernier/config.json";
  return {};
}

Result<json> readConfig() {
  const std::string path = configPath();
  std::error_code ec;
  if (path.empty() || !std::filesystem::exists(path, ec)) return json::object();
  json j = json::value_t::discarded;
  if (std::filesystem::is_regular_file(path, ec) && std::filesystem::file_size(path, ec) <= kMaxConfigBytes) {
    std::ifstream f(path);
    j = json::parse(f, nullptr, false);
  }
  if (j.is_discarded() || !j.is_object())
    return makeError(ErrorCode::OptionInvalid,
                     "The settings file is not a JSON object of at most 1 MiB; mend or remove it.",
                     "config.json");
  return j;
}

// The text of a setting and where it came from; numbers in the file become text, so that one check serves
// all.
Setting pick(const std::string& name, const std::optional<std::string>& flag, const json& config,
             const std::string& fallback) {
  if (flag) return {name, *flag, "flag"};
  std::string variable = "VERNIER_" + name;
  for (char& c : variable) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 32 : c);
  if (const char* v = std::getenv(variable.c_str()); v && *v) return {name, v, variable};
  if (config.contains(name)) {
    const json& v = config.at(name);
    return {name, v.is_string() ? v.get<std::string>() : v.dump(), "config.json"};
  }
  return {name, fallback, "default"};
}

Result<long> wholeNumber(const Setting& s, long least, long most) {
  long n = 0;
  const char* end = s.value.data() + s.value.size();
  const auto [p, ec] = std::from_chars(s.value.data(), end, n);
  if (ec != std::errc() || p != end || n < least || n > most)
    return makeError(ErrorCode::OptionInvalid,
                     s.name + " is '" + s.value + "'; expected a whole number from " + std::to_string(least) +
                         " to " + std::to_string(most) + ".",
                     s.source);
  return n;
}
}  // namespace

Result<Settings> readSettings(const SettingFlags& flags) {
  const Result<json> config = readConfig();
  if (!config) return config.error();
  Settings s;
  const auto flagThreads =
      flags.threads ? std::optional<std::string>(std::to_string(*flags.threads)) : std::nullopt;
  const Setting threads = pick("threads", flagThreads, *config, "0");
  const Setting memory = pick("memory_mb", std::nullopt, *config, "0");
  const Setting engine = pick("engine", flags.engine, *config, "auto");
  const Setting plugins = pick("plugins", std::nullopt, *config, "");

  const Result<long> t = wholeNumber(threads, 0, 1024);
  if (!t) return t.error();
  s.threads = static_cast<int>(*t);
  const Result<long> m = wholeNumber(memory, 0, 1L << 30);
  if (!m) return m.error();
  s.memory_mb = static_cast<std::uint64_t>(*m);
  if (engine.value != "auto" && engine.value != "gl" && engine.value != "native")
    return makeError(ErrorCode::OptionInvalid,
                     "engine is '" + engine.value + "'; expected auto, gl or native.", engine.source);
  s.engine = engine.value;
  s.pluginFolders = flags.pluginFolders;
  for (std::size_t at = 0; at < plugins.value.size();) {
    const std::size_t end = std::min(plugins.value.find(':', at), plugins.value.size());
    if (end > at) s.pluginFolders.push_back(plugins.value.substr(at, end - at));
    at = end + 1;
  }
  s.noticeSeen = config->contains("notice_seen") && config->at("notice_seen") == true;
  s.sources = {threads, memory, engine, plugins};
  return s;
}

Result<void> checkSettingsFolder() {
  namespace fs = std::filesystem;
  const std::string path = configPath();
  if (path.empty())
    return makeError(
        ErrorCode::WriteFailed,
        "There is no settings folder (neither HOME nor XDG_CONFIG_HOME is set), so changes are not kept.",
        "config.json");
  std::error_code ec;
  fs::path folder = fs::absolute(path, ec).parent_path();
  while (!fs::exists(folder, ec) && folder.has_relative_path()) folder = folder.parent_path();
  if (fs::is_directory(folder, ec) && ::access(folder.c_str(), W_OK | X_OK) == 0) return {};
  return makeError(
      ErrorCode::WriteFailed,
      "The settings folder cannot be written, so changes of settings are not kept; mend its permissions "
      "or set XDG_CONFIG_HOME to a folder that can.",
      "config.json");
}

Result<void> rememberNoticeSeen() {
  const std::string path = configPath();
  if (path.empty()) return makeError(ErrorCode::WriteFailed, "There is no home folder to keep settings in.");
  Result<json> config = readConfig();
  if (!config) return config.error();
  (*config)["notice_seen"] = true;
  std::error_code ec;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ec);
  return writeFileWhole(path, config->dump(2) + "\n");
}

}  // namespace vernier::app
