// SPDX-License-Identifier: GPL-3.0-or-later
// Where tests find the real data. A test that wants it begins with VERNIER_NEEDS_DATA("folder"): without the
// folder it says so and passes, since the data is not part of this repository.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

#include "TestPaths.h"

namespace vernier::test {

inline std::filesystem::path dataDir() {
  const char* env = std::getenv("VERNIER_DATA_DIR");
  return env && *env ? std::filesystem::path(env) : std::filesystem::path(VERNIER_DATA_DIR);
}

// A fresh folder of this process, removed at the end.
class TempDir {
 public:
  TempDir() {
    std::string pattern = (std::filesystem::temp_directory_path() / "vernier-test-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TempDir() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace vernier::test

#define VERNIER_NEEDS_DATA(folder)                                                                  \
  if (!std::filesystem::exists(vernier::test::dataDir() / (folder))) {                              \
    std::cout << "[  NOTE    ] shared data folder '" << (folder) << "' is not here: not checked\n"; \
    return;                                                                                         \
  }
