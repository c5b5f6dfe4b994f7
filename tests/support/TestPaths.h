// SPDX-License-Identifier: GPL-3.0-or-later
// Where the checkout, its build and the shared data lie. Kept out of the tests' own flags, so that a compiler
// cache serves every checkout, whatever its folder.
#pragma once

namespace vernier::test {
extern const char* const kSourceDir;
extern const char* const kBuildDir;
extern const char* const kDataDir;
}  // namespace vernier::test

#define VERNIER_SOURCE_DIR ::vernier::test::kSourceDir
#define VERNIER_BUILD_DIR ::vernier::test::kBuildDir
#define VERNIER_DATA_DIR ::vernier::test::kDataDir
