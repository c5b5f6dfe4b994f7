// SPDX-License-Identifier: GPL-3.0-or-later
// The log names tags, counts and codes, never values, file names or paths of patients. It goes to stderr and
// is silent below `warning` unless VERNIER_LOG=info|debug.
#pragma once
#include <string_view>

#include "vernier/base/Api.h"

namespace vernier {
enum class LogLevel { Debug, Info, Warning, Error };
VERNIER_API void log(LogLevel, std::string_view room, std::string_view message);
}  // namespace vernier
