// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Libraries.h"

#include <gtest/gtest.h>

#include <cstdio>

TEST(Libraries, TheImageLibrarySaysItsVersion) {
  // Not by std::regex, whose templates g++ 12 suspects of uninitialised values when they are sanitized.
  int version[3] = {};
  const std::string name = vernier::measure::imageLibrary();
  EXPECT_EQ(std::sscanf(name.c_str(), "OpenCV %d.%d.%d", &version[0], &version[1], &version[2]), 3) << name;
}
