// SPDX-License-Identifier: GPL-3.0-or-later
// How many threads Vernier may use. parallelFor is the one way in which modules spread work: oneTBB stays
// behind it.
#pragma once
#include <cstddef>
#include <functional>

#include "vernier/base/Api.h"

namespace vernier {

// 0 = all cores. Call before work begins; also sets LP_NUM_THREADS for a later OSMesa context.
VERNIER_API void setThreads(int n);
VERNIER_API int threads();

// Calls body(begin, end) on disjoint ranges that cover [0, n), each at most `grain` long, on up to threads()
// threads. body must not throw. Returns when all are done.
VERNIER_API void parallelFor(std::size_t n, std::size_t grain,
                             const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace vernier
