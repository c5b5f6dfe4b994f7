// SPDX-License-Identifier: GPL-3.0-or-later
// The grid of a stack from which some slices are missing after all, because they could not be decoded.
#pragma once
#include <cstddef>
#include <vector>

#include "vernier/base/GridGeometry.h"

namespace vernier {

// `kept`: ascending slice indices, at least one. What is left keeps its place in the patient; between the
// neighbours of a dropped slice there is a gap. At the two ends of an even lattice dropping only makes it
// shorter.
GridGeometry withoutSlices(const GridGeometry&, const std::vector<std::size_t>& kept);

}  // namespace vernier
