// SPDX-License-Identifier: GPL-3.0-or-later
// Every error code has a test that provokes it: its name stands in an assertion of some test. The sources of
// the tests are searched, so a code without a test fails here by name.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "TestPaths.h"
#include "vernier/base/Result.h"

namespace vernier {
namespace {
namespace fs = std::filesystem;

TEST(Errors, EveryCodeHasAProvokingTest) {
  std::map<std::string, int> seen;
#define VERNIER_ERROR(name, cls, exit, text) seen[#name] = 0;
#include "vernier/base/errors.def"
#undef VERNIER_ERROR
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(VERNIER_SOURCE_DIR) / "tests")) {
    if (entry.path().extension() != ".cpp" || entry.path().filename() == "ErrorsTest.cpp") continue;
    std::ifstream f(entry.path());
    std::string code;  // without comments: to name a code there provokes nothing
    for (std::string line; std::getline(f, line);) code += line.substr(0, line.find("//")) + "\n";
    for (auto& [name, count] : seen)
      for (const std::string& mention : {"ErrorCode::" + name, "\"" + name + "\""})
        if (code.find(mention) != std::string::npos) ++count;
  }
  for (const auto& [name, count] : seen) EXPECT_GT(count, 0) << name << " has no test that provokes it";
}

}  // namespace
}  // namespace vernier
