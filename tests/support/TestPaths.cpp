// SPDX-License-Identifier: GPL-3.0-or-later
#include "TestPaths.h"

namespace vernier::test {
const char* const kSourceDir = PATH_SOURCE;
const char* const kBuildDir = PATH_BUILD;
const char* const kDataDir = PATH_DATA;
}  // namespace vernier::test
