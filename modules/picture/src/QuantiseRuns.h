// SPDX-License-Identifier: GPL-3.0-or-later
// The vector code of quantise(Images): compiled once per instruction set, the same levels on each.
#pragma once
#include <cstddef>
#include <cstdint>

namespace vernier {

// n pixels of RGBA to RGB; a NaN in red, green or blue gives kMarker.
void quantiseRuns(const float* rgba, std::size_t n, std::uint8_t* rgb);

}  // namespace vernier
