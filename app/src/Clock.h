// SPDX-License-Identifier: GPL-3.0-or-later
// Wall time of a piece of work, for reports and benches; nothing else depends on it.
#pragma once
#include <chrono>

namespace vernier::app {

using Clock = std::chrono::steady_clock;
inline double msSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

}  // namespace vernier::app
