// SPDX-License-Identifier: GPL-3.0-or-later
// Windows of an enhanced object: per-frame functional group, else the shared one, never the root (PS3.3
// C.7.6.16.2.10).
#pragma once
#include <cstddef>

#include "Header.h"

namespace vernier {

// How many different windows the frames carry; 0 when none does.
std::size_t differentFrameWindows(const Header& header);

}  // namespace vernier
