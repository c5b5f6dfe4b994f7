// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Libraries.h"

#include <gtest/gtest.h>

#include <regex>

TEST(Libraries, TheImageLibrarySaysItsVersion) {
  EXPECT_TRUE(std::regex_match(vernier::measure::imageLibrary(), std::regex("OpenCV \\d+\\.\\d+\\.\\d+.*")));
}
