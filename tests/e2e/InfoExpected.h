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

}  // namespace vernier::test
