// SPDX-License-Identifier: GPL-3.0-or-later
#include "DicomDir.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "Text.h"

namespace vernier {
namespace {
namespace fs = std::filesystem;

std::string lower(std::string s) {
  for (char& c : s) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return s;
}

// The entry of `folder` with that name; disks lose the upper case of file IDs.
fs::path entryOf(const fs::path& folder, const std::string& name) {
  std::error_code ec;
  if (fs::exists(folder / name, ec)) return folder / name;
  for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec))
    if (lower(it->path().filename().string()) == lower(name)) return it->path();
  return {};
}

fs::path resolve(const fs::path& folder, const std::vector<std::string>& components) {
  fs::path p = folder;
  for (const std::string& c : components) {
    if (c.empty() || c == "." || c == ".." || c.find('/') != std::string::npos) return {};
    p = entryOf(p, c);
    if (p.empty()) return {};
  }
  std::error_code ec;
  const fs::path root = fs::canonical(folder, ec), target = fs::canonical(p, ec);
  if (ec || !fs::is_regular_file(target, ec)) return {};
  const auto [r, t] = std::mismatch(root.begin(), root.end(), target.begin(), target.end());
  return r == root.end() ? p : fs::path();
}

}  // namespace

DicomDirIndex readDicomDir(const Header& header, const std::string& folder) {
  DicomDirIndex index;
  const Element* sequence = header.find(0x00041220);
  if (!sequence) return index;
  for (const auto& item : itemsOf(header, *sequence)) {
    if (const Element* type = findIn(item, 0x00041430)) ++index.records[std::string(rawText(header, *type))];
    const Element* id = findIn(item, 0x00041500);
    if (!id || id->length == 0) continue;
    ++index.referenced;
    const fs::path p = resolve(folder, splitValues(rawText(header, *id)));
    if (p.empty()) continue;
    ++index.present;
    index.files.push_back(p.string());
  }
  return index;
}

}  // namespace vernier
