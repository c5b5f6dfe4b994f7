// SPDX-License-Identifier: GPL-3.0-or-later
// Session, third part: surfaces by the names that scenes give them.
#include <filesystem>

#include "SessionImpl.h"
#include "vernier/base/Trace.h"

namespace vernier::app {

Result<void> Session::addSurface(const std::string& name, const std::string& path, std::stop_token stop) {
  Result<SurfaceFile> file = readSurface(path, {&impl_->budget}, stop);
  if (!file) return file.error();
  impl_->surfaces[name] = std::make_shared<const SurfaceFile>(std::move(*file));
  impl_->surfacePaths[name] = path;
  return {};
}

Result<std::string> Session::addSurface(const std::string& path, std::stop_token stop) {
  const std::string plain = std::filesystem::path(path).filename().string();
  std::string name = plain;
  for (int n = 2; impl_->surfacePaths.contains(name) && impl_->surfacePaths[name] != path; ++n)
    name = plain + "#" + std::to_string(n);
  if (impl_->surfaces.contains(name)) return name;
  if (const Result<void> added = addSurface(name, path, stop); !added) return added.error();
  return name;
}

std::vector<std::string> Session::surfaceFiles() const {
  std::vector<std::string> files;
  for (const auto& [name, path] : impl_->surfacePaths) files.push_back(path);
  return files;
}

std::shared_ptr<const SurfaceFile> Session::surface(const std::string& name) const {
  const auto it = impl_->surfaces.find(name);
  return it == impl_->surfaces.end() ? nullptr : it->second;
}

}  // namespace vernier::app
