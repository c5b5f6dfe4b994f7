// SPDX-License-Identifier: GPL-3.0-or-later
// Where combiner files lie, and how one is found by its name.
#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "Combiner.h"

namespace vernier::dvr {
namespace {
namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = 64 * 1024;
constexpr const char* kBesideProgram = "../lib/vernier/plugins/dvr/combiners";

// Of the library, or the program, that this code was linked into.
fs::path ownFolder() {
  std::error_code ec;
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&combinerFolders), &info) != 0 && info.dli_fname) {
    const fs::path file = fs::canonical(info.dli_fname, ec);
    if (!ec) return file.parent_path();
  }
  return fs::read_symlink("/proc/self/exe", ec).parent_path();
}

std::string userFolder() {
  if (const char* xdg = std::getenv("XDG_CONFIG_HOME"); xdg && *xdg)
    return std::string(xdg) + "/vernier/combiners";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::string(home) + "/.config/vernier/combiners";
  return {};
}

// What may stand in a scene as a combiner's name: no path leads out of the folders.
bool isName(const std::string& s) {
  return !s.empty() && s.size() <= 64 && std::all_of(s.begin(), s.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  });
}

Error unknown(const std::string& name, const std::vector<std::string>& folders) {
  std::string known;
  for (const std::string& n : combinerNames(folders)) known += (known.empty() ? "" : ", ") + n;
  if (known.empty())
    return makeError(ErrorCode::SceneInvalid,
                     "There is no combiner '" + name + "', nor any other; reinstall the plugin dvr.", name);
  return makeError(ErrorCode::SceneInvalid, "There is no combiner '" + name + "'; there are " + known + ".",
                   name);
}

Result<std::string> textOf(const std::string& name, const std::vector<std::string>& folders) {
  if (!isName(name)) return unknown(name, folders);
  for (const std::string& folder : folders) {
    const fs::path path = fs::path(folder) / (name + ".json");
    std::error_code ec;
    if (!fs::is_regular_file(path, ec)) continue;
    const std::uintmax_t size = fs::file_size(path, ec);
    std::ifstream file(path, std::ios::binary);
    if (ec || !file || size > kMostBytes)
      return makeError(ErrorCode::SceneInvalid,
                       "The combiner's file cannot be read, or has more than 65536 bytes.", name + ".json#");
    return std::string(std::istreambuf_iterator<char>(file), {});
  }
  return unknown(name, folders);
}

}  // namespace

std::vector<std::string> combinerFolders() {
  std::vector<std::string> folders;
  std::error_code ec;
  for (const fs::path& p : {ownFolder() / "combiners", ownFolder() / kBesideProgram})
    if (folders.empty() && fs::is_directory(p, ec)) folders.push_back(p.lexically_normal().string());
  if (const std::string user = userFolder(); !user.empty()) folders.push_back(user);
  return folders;
}

std::vector<std::string> combinerNames(const std::vector<std::string>& folders) {
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    std::error_code ec;
    for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
      const std::string stem = it->path().stem().string();
      if (it->path().extension() == ".json" && isName(stem)) names.push_back(stem);
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

Result<Combiner> findCombiner(const std::string& name, const std::vector<std::string>& folders) {
  const Result<std::string> text = textOf(name, folders);
  if (!text) return text.error();
  return parseCombiner(*text, name, [&](const std::string& base) { return textOf(base, folders); });
}

}  // namespace vernier::dvr
