// SPDX-License-Identifier: GPL-3.0-or-later
// One parallel pass over the voxels at load time: extrema without no-data, and the count of what is not
// finite.
#pragma once
#include <cstdint>
#include <optional>

#include "vernier/volume/Volume.h"

namespace vernier {

struct NonFinite {
  std::uint64_t nan = 0, plusInf = 0, minusInf = 0;
  std::uint64_t all() const { return nan + plusInf + minusInf; }
};

// Turns infinite floats into NaN and counts what was not finite. No-op for integer types.
NonFinite cleanFloats(VoxelType type, std::byte* voxels, std::size_t count);

// Modality extrema of `slices` slices of `perSlice` voxels; rescale has one entry or one per slice.
std::optional<Volume::Range> modalityExtrema(VoxelType type, const std::byte* voxels, std::size_t perSlice,
                                             std::size_t slices, const std::vector<ModalityRescale>& rescale,
                                             const std::optional<NoDataRange>& noData);

}  // namespace vernier
