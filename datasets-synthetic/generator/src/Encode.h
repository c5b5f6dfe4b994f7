// SPDX-License-Identifier: GPL-3.0-or-later
// One frame of stored values as the codestream of a compressed transfer syntax (PS3.5 annex A.4, G for RLE).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "Plan.h"

namespace vernier::phantoms {

// True for the syntaxes whose pixel data is encapsulated.
bool isEncapsulated(const std::string& transferSyntaxUid);

// The codestream, padded to even length. Throws std::runtime_error where a codec refuses (a mistake of ours).
std::vector<std::uint8_t> encodeFrame(const SeriesPlan&, const std::vector<std::int32_t>& stored);

}  // namespace vernier::phantoms
