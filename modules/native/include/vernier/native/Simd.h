// SPDX-License-Identifier: GPL-3.0-or-later
// Which SIMD instruction set the native kernels use here (Highway's run-time dispatch).
#pragma once
#include <string>
#include <vector>

#include "vernier/base/Api.h"

namespace vernier::native {

VERNIER_API std::string simdTarget();  // such as "AVX3" or "SSE4"

// For tests: the targets that were built and run here, best first; and a way to choose one ("" = the best
// again). Not thread-safe. False for a target that is not in the list.
VERNIER_API std::vector<std::string> simdTargets();
VERNIER_API bool useSimdTarget(const std::string& name);

}  // namespace vernier::native
