// SPDX-License-Identifier: GPL-3.0-or-later
// Progress of one piece of work. Called from worker threads, one call at a time; done <= total, total may
// grow.
#pragma once
#include <cstdint>
#include <functional>
#include <string_view>

namespace vernier {
using ProgressFn = std::function<void(std::string_view stage, std::uint64_t done, std::uint64_t total)>;
}  // namespace vernier
