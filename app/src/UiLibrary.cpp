// SPDX-License-Identifier: GPL-3.0-or-later
#include "UiLibrary.h"

#include <dlfcn.h>

#include <cstring>
#include <filesystem>

#include "vernier/AbiId.h"

namespace vernier::app {
namespace {

Error unavailable(const std::string& sentence) {
  return makeError(ErrorCode::WindowUnavailable, sentence, "window");
}

struct Library {
  UiRunFn run = nullptr;
};

Result<Library> openLibrary() {
  const std::filesystem::path path =
      std::filesystem::path(PluginHost::installFolder()).parent_path() / "libvernier_ui.so";
  std::error_code ec;
  if (!std::filesystem::exists(path, ec))
    return unavailable(
        "The window is not installed (lib/vernier/libvernier_ui.so is missing); the other commands work "
        "without it.");
  // Never closed: GL drivers keep threads that outlive their library otherwise.
  void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    std::string why = dlerror();
    const std::size_t colon = why.find(':');  // "libglfw.so.3: cannot open shared object file..."
    return unavailable("The window needs a library that is not here (" + why.substr(0, colon) +
                       "); install libglfw3 and libgl1, or use the other commands, which need none.");
  }
  const auto abi = reinterpret_cast<UiAbiFn>(dlsym(handle, "vernierUiAbi"));
  const auto run = reinterpret_cast<UiRunFn>(dlsym(handle, "vernierUiRun"));
  if (!abi || !run || std::strcmp(abi(), VERNIER_ABI_ID) != 0)
    return unavailable(
        "libvernier_ui.so is of another build than this program; install both from one package.");
  return Library{run};
}

Result<void> resultOf(const UiAnswer& answer) {
  if (answer.code < 0) return {};
  return makeError(static_cast<ErrorCode>(answer.code), answer.sentence, "window");
}

}  // namespace

Result<void> checkUiLibrary() {
  const Result<Library> library = openLibrary();
  if (!library) return library.error();
  return {};
}

Result<void> runWindow(const UiStart& start) {
  const Result<Library> library = openLibrary();
  if (!library) return library.error();
  UiAnswer answer;
  library->run(&start, &answer);
  return resultOf(answer);
}

}  // namespace vernier::app
