// SPDX-License-Identifier: GPL-3.0-or-later
#include "VtkSymbol.h"

#include <dlfcn.h>

#include <filesystem>
#include <vector>

namespace vernier {
namespace {

// Beside what this code was linked into, as installed; below it, or beside it, as built.
std::vector<std::filesystem::path> places() {
  static const char here = 0;
  Dl_info info{};
  if (::dladdr(&here, &info) == 0 || !info.dli_fname) return {};
  const std::filesystem::path folder = std::filesystem::absolute(info.dli_fname).parent_path();
  return {folder / kVtkLibrary, folder / "vernier" / kVtkLibrary,
          folder.parent_path() / "lib" / "vernier" / kVtkLibrary};
}

}  // namespace

void* vtkSymbol(const char* name) {
  static void* const library = []() -> void* {
    for (const std::filesystem::path& path : places())
      if (void* found = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) return found;
    return nullptr;
  }();
  return library ? ::dlsym(library, name) : nullptr;
}

}  // namespace vernier
