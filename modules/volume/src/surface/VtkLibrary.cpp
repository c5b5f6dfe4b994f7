// SPDX-License-Identifier: GPL-3.0-or-later
#include <dlfcn.h>

#include <filesystem>

#include "VtkPolyData.h"

namespace vernier::surface {
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

// Loaded once, never closed: VTK keeps objects of its own until the program ends.
VtkReadFn* reader() {
  static VtkReadFn* const found = []() -> VtkReadFn* {
    for (const std::filesystem::path& path : places())
      if (void* library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL))
        return reinterpret_cast<VtkReadFn*>(::dlsym(library, kVtkReadName));
    return nullptr;
  }();
  return found;
}

}  // namespace

Result<VtkPolyData> readVtpBytes(std::string_view bytes) {
  VtkReadFn* const read = reader();
  if (!read)
    return makeError(
        ErrorCode::FormatUnknown,
        "Reading VTP needs VTK's libraries, which are not here; install Debian's libvtk9.1, or save "
        "the surface as PLY.");
  VtkPolyData out;
  read(bytes.data(), bytes.size(), &out);
  return out;
}

}  // namespace vernier::surface
