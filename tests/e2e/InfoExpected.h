// SPDX-License-Identifier: GPL-3.0-or-later
// One run of `info --json` over a folder of the shared data beside what data/expected says of it.
#pragma once
#include <gtest/gtest.h>

#include <iostream>

#include "ExpectedFacts.h"
#include "TestData.h"

namespace vernier::test {

class InfoExpected : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    here_ =
        std::filesystem::exists(dataDir() / GetParam()) && std::filesystem::exists(dataDir() / "expected");
    if (!here_) {
      std::cout << "[  NOTE    ] shared data folder '" << GetParam() << "' is not here: not checked\n";
      return;
    }
    facts_ = factsOf(GetParam());
  }
  bool here_ = false;
  Facts facts_;
};

// Objects whose values or geometry a later version reads: enhanced multi-frame, segmentation, dose.
inline bool leftToLater(const Json& object) {
  const std::string why = object.value("not_shown", "");
  return why.starts_with("not shown yet: enhanced") || why.starts_with("not shown yet: segmentation") ||
         why.starts_with("not shown yet: radiotherapy dose");
}

}  // namespace vernier::test
