// SPDX-License-Identifier: GPL-3.0-or-later
// A process-wide counter: every immutable thing that derived data can be made of takes one number at birth.
#pragma once
#include <cstdint>

#include "vernier/base/Api.h"

namespace vernier {
using Revision = std::uint64_t;
VERNIER_API Revision nextRevision();  // thread-safe; never 0
}  // namespace vernier
