// SPDX-License-Identifier: GPL-3.0-or-later
// Lookup tables of a data set: modality, VOI and presentation LUTs (PS3.3 C.11) and palettes (C.7.6.3.1.5,
// C.7.9). No count of a table is trusted: its data must hold what its descriptor says.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "Header.h"
#include "vernier/study/Model.h"

namespace vernier {

// LUT Descriptor and LUT Data of one item; nullopt when they are missing or contradict each other.
// `signedInput`: how the first value mapped is to be read where the VR does not say.
std::optional<LutTable> lutFrom(const Header&, const std::vector<Element>& item, bool signedInput);

struct PaletteResult {
  std::shared_ptr<const Palette> palette;
  std::string
      corrected;  // one sentence where a description was wrong in a way that every reader settles alike
};
// The palette of the object. PixelDescriptionInvalid where it is missing, where a table holds fewer entries
// than its descriptor says, or where a segmented table does not come to that number.
Result<PaletteResult> paletteFrom(const Header&, bool signedIndex);

// The values of a segmented table (C.7.9.2): `data` are its 16-bit words (or bytes, of an 8-bit table).
// nullopt when they do not make exactly `entries` values.
std::optional<std::vector<std::uint16_t>> expandSegments(const std::vector<std::uint16_t>& data,
                                                         std::size_t entries, bool eightBit);

}  // namespace vernier
