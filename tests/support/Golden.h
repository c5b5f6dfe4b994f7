// SPDX-License-Identifier: GPL-3.0-or-later
// Plans as text against the goldens under tests/plan.
#pragma once
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "TestPaths.h"

namespace vernier::test {

// Compares with tests/plan/NAME.plan.txt; a missing golden is a failure that leaves the text in the build
// folder.
inline void expectGolden(const std::string& name, const std::string& text) {
  const std::string file = name + ".plan.txt";
  std::ifstream in(std::string(VERNIER_SOURCE_DIR) + "/tests/plan/" + file);
  std::stringstream golden;
  golden << in.rdbuf();
  if (in && golden.str() == text) return;
  std::ofstream(std::string(VERNIER_BUILD_DIR) + "/" + file) << text;
  ADD_FAILURE() << (in ? "differs from" : "there is no") << " tests/plan/" << file << "; this run's text:\n"
                << text;
}

}  // namespace vernier::test
