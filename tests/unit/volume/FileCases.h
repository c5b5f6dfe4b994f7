// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of volume files share.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "TestData.h"
#include "vernier/study/Findings.h"
#include "vernier/study/Load.h"

namespace vernier::test {

inline std::string bytesOfFile(const std::filesystem::path& p) {
  std::ifstream f(p, std::ios::binary);
  EXPECT_TRUE(f.good()) << p;
  std::stringstream s;
  s << f.rdbuf();
  return s.str();
}

inline bool has(const std::vector<Finding>& findings, const std::string& code) {
  return std::any_of(findings.begin(), findings.end(), [&](const Finding& f) { return f.code == code; });
}

}  // namespace vernier::test
