// SPDX-License-Identifier: GPL-3.0-or-later
// Stored values of one slice: the field at every voxel's centre, noise, rescale, rounding, padding.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "Plan.h"

namespace vernier::phantoms {

struct StoredRange {
  int low, high;
};
StoredRange storedRange(const SeriesPlan&);

// Stored values before any compression, row by row.
std::vector<std::int32_t> sampleSlice(const Field&, const SeriesPlan&, const SlicePlan&, std::uint64_t seed);

double slopeOf(const SeriesPlan&, const SlicePlan&);
// The same for the first `channels` fields, interleaved by pixel.
std::vector<std::int32_t> sampleChannels(const std::vector<const Field*>&, std::size_t channels,
                                         const SeriesPlan&, const SlicePlan&, std::uint64_t seed);

// The field without noise at a patient point, in modality units.
double idealAt(const Field&, glm::dvec3 p_mm);

}  // namespace vernier::phantoms
