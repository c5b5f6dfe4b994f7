// SPDX-License-Identifier: GPL-3.0-or-later
// The first series as MetaImage: NAME.mhd and NAME.raw, stored values, little endian, LPS.
#pragma once
#include <filesystem>

#include "Plan.h"
#include "vernier/base/Result.h"

namespace vernier::phantoms {

// volume: all slices, ascending along the normal. OptionInvalid unless the slices are one even lattice.
Result<void> canBeMetaImage(const StudyPlan&);
Result<void> writeMetaImage(const SeriesPlan&, const std::vector<std::int16_t>& volume,
                            const std::filesystem::path& mhd);
// Several channels of 8 bits, interleaved by voxel.
Result<void> writeMetaImage(const SeriesPlan&, const std::vector<std::uint8_t>& interleaved,
                            const std::filesystem::path& mhd);

}  // namespace vernier::phantoms
