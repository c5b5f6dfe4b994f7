// SPDX-License-Identifier: GPL-3.0-or-later
// The colours of a PALETTE COLOR image: one entry of red, green and blue for each index (PS3.3 C.7.6.3.1.5,
// C.7.6.3.1.6, segmented tables C.7.9 written out). Plain data.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace vernier {

struct Palette {
  double firstMapped = 0;                             // the index that takes entries[0]
  std::uint32_t bits = 16;                            // of an entry: 8 or 16
  std::vector<std::array<std::uint16_t, 3>> entries;  // never empty in an Instance

  // What full intensity is: 255 or 65535; 65280 where all entries are 8-bit values in the high bytes of 16
  // bits, as the standard's own palettes once were written.
  double fullScale = 65535;
  // Indices before the first one mapped take the first entry, those past the last take the last.
  const std::array<std::uint16_t, 3>& at(double index) const {
    const double last = static_cast<double>(entries.size() - 1);
    return entries[static_cast<std::size_t>(std::clamp(std::floor(index - firstMapped), 0.0, last))];
  }
};

}  // namespace vernier
