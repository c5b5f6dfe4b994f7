// SPDX-License-Identifier: GPL-3.0-or-later
// Percentiles of modality values over many slices without sorting: two histograms of 16 bits each over keys
// that order as the values do. Exact: the result is a value that occurs (where slopes differ between slices,
// to float).
#pragma once
#include <optional>
#include <vector>

#include "vernier/volume/Volume.h"

namespace vernier {

struct SliceValues {
  const std::byte* data = nullptr;
  std::size_t count = 0;
  ModalityRescale rescale;
};

// The values of (nearest) rank ceil(p n) for p = 0.01 and 0.99; nullopt when all is excluded or not a number.
std::optional<Volume::Range> percentiles1And99(VoxelType, const std::vector<SliceValues>&,
                                               const std::optional<NoDataRange>& excluded);

// The window that shows `range` from black to white, LINEAR_EXACT; least_width > 0 where the range is one
// value, which then shows as mid grey. Without a range (no data at all): 0..1.
VoiWindow windowOver(const std::optional<Volume::Range>& range, double leastWidth_val);

// One step of the stored values in modality units, 1 for floats: the least width of an automatic window.
double leastWidth(VoxelType, const ModalityRescale&);

}  // namespace vernier
