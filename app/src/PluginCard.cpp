// SPDX-License-Identifier: GPL-3.0-or-later
#include "PluginCard.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "vernier/base/Guarded.h"

namespace vernier::app {
namespace {
using nlohmann::json;

constexpr std::uintmax_t kMaxCardBytes = 64 * 1024;

Error damaged(const std::string& what) {
  return makeError(ErrorCode::PluginFailed, "The card " + what + "; reinstall the plugin.", "plugin.json");
}

std::vector<std::string> texts(const json& j, const char* key) {
  return j.contains(key) ? j.at(key).get<std::vector<std::string>>() : std::vector<std::string>{};
}
}  // namespace

Result<PluginCard> readPluginCard(const std::string& path) {
  std::error_code ec;
  const auto size = std::filesystem::file_size(path, ec);
  if (ec) return damaged("is missing");
  if (size > kMaxCardBytes) return damaged("is larger than 64 KiB");
  std::ifstream f(path);
  const json j = json::parse(f, nullptr, false);
  if (j.is_discarded() || !j.is_object()) return damaged("is not a JSON object");
  for (const char* key : {"name", "version", "interface", "library"})
    if (!j.contains(key) || !j.at(key).is_string() || j.at(key).get<std::string>().empty())
      return damaged(std::string("has no text under '") + key + "'");
  for (const char* key : {"kinds", "views", "needs"})
    if (j.contains(key) &&
        (!j.at(key).is_array() ||
         !std::all_of(j.at(key).begin(), j.at(key).end(), [](const json& x) { return x.is_string(); })))
      return damaged(std::string("has no list of texts under '") + key + "'");
  PluginCard card;
  card.name = j.at("name");
  card.version = j.at("version");
  card.interface = j.at("interface");
  card.library = j.at("library");
  if (card.library.find('/') != std::string::npos) return damaged("names a library outside its folder");
  if (j.contains("description") && j.at("description").is_string()) card.description = j.at("description");
  card.kinds = texts(j, "kinds");
  card.views = texts(j, "views");
  card.needs = texts(j, "needs");
  return card;
}

}  // namespace vernier::app
