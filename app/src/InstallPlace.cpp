// SPDX-License-Identifier: GPL-3.0-or-later
#include "InstallPlace.h"

#include <sys/auxv.h>

#include <filesystem>

namespace vernier::app {
namespace fs = std::filesystem;

std::string programFile() {
  std::error_code ec;
  fs::path program = fs::read_symlink("/proc/self/exe", ec);
  if (ec)  // a bare root folder without /proc
    program = fs::canonical(reinterpret_cast<const char*>(::getauxval(AT_EXECFN)), ec);
  return program.string();
}

std::string installPrefix() {
  return fs::path(programFile()).parent_path().parent_path().lexically_normal().string();
}

std::string clinicSuiteFolder() { return installPrefix() + "/share/vernier/clinic"; }

}  // namespace vernier::app
