// SPDX-License-Identifier: GPL-3.0-or-later
#include "DicomDir.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>

#include "Text.h"

namespace vernier {
namespace {
namespace fs = std::filesystem;

// What disks make of a file ID: upper case may be lost, and ISO 9660 adds a version (";1") or an empty
// extension (".").
std::string plainName(std::string s) {
  if (const std::size_t version = s.rfind(';');
      version != std::string::npos && s.find_first_not_of("0123456789", version + 1) == std::string::npos)
    s.resize(version);
  if (s.size() > 1 && s.back() == '.') s.pop_back();
  for (char& c : s) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return s;
}

class Resolver {
 public:
  explicit Resolver(fs::path folder) : folder_(std::move(folder)) {
    std::error_code ec;
    root_ = fs::canonical(folder_, ec);
  }

  enum class Found { There, Missing, Outside };
  Found find(const std::vector<std::string>& components, fs::path& out) {
    fs::path p = folder_;
    for (const std::string& c : components)
      if (c == ".." || c.find('/') != std::string::npos) return Found::Outside;
    for (const std::string& c : components) {
      if (c.empty() || c == ".") return Found::Missing;
      p = entryOf(p, c);
      if (p.empty()) return Found::Missing;
    }
    std::error_code ec;
    const fs::path target = fs::canonical(p, ec);
    if (ec || root_.empty()) return Found::Missing;
    const auto [r, t] = std::mismatch(root_.begin(), root_.end(), target.begin(), target.end());
    if (r != root_.end()) return Found::Outside;
    if (!fs::is_regular_file(target, ec)) return Found::Missing;
    out = p;
    return Found::There;
  }

 private:
  fs::path entryOf(const fs::path& folder, const std::string& name) {
    std::error_code ec;
    if (fs::exists(folder / name, ec)) return folder / name;
    const auto [at, isNew] = names_.try_emplace(folder.string());
    if (isNew)
      for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec))
        at->second.emplace(plainName(it->path().filename().string()), it->path());
    const auto found = at->second.find(plainName(name));
    return found == at->second.end() ? fs::path() : found->second;
  }

  fs::path folder_, root_;
  std::map<std::string, std::map<std::string, fs::path>> names_;  // of folders that were listed
};

}  // namespace

DicomDirIndex readDicomDir(const Header& header, const std::string& folder, bool resolve) {
  DicomDirIndex index;
  Resolver resolver(folder.empty() ? fs::path(".") : fs::path(folder));
  const Element* sequence = header.find(0x00041220);
  if (!sequence) return index;
  for (const auto& item : itemsOf(header, *sequence)) {
    if (const Element* type = findIn(item, 0x00041430)) ++index.records[std::string(rawText(header, *type))];
    const Element* id = findIn(item, 0x00041500);
    if (!id || id->length == 0) continue;
    ++index.referenced;
    if (!resolve) continue;
    fs::path p;
    const auto found = resolver.find(splitValues(rawText(header, *id)), p);
    index.outside += found == Resolver::Found::Outside;
    if (found != Resolver::Found::There) continue;
    ++index.present;
    index.files.push_back(p.string());
  }
  return index;
}

}  // namespace vernier
