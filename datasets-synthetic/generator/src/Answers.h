// SPDX-License-Identifier: GPL-3.0-or-later
// What is true of a phantom, as JSON: geometry, sums of stored values, probes, lengths, angles, areas,
// volumes, findings. Lengths and the like are closed forms of the recipe's solids, never measured on pixels.
#pragma once
#include <vector>

#include "Plan.h"

namespace vernier::phantoms {

// Sums over one slice's stored values before compression.
struct SliceSums {
  std::int64_t sum = 0;
  int low = 0, high = 0;
};
SliceSums sumsOf(const std::vector<std::int32_t>& stored);

// sums[series][slice], as in the plan.
Json answersOf(const Json& recipe, const std::string& variant, const StudyPlan&,
               const std::vector<const Field*>&, const std::vector<Solid>&,
               const std::vector<std::vector<SliceSums>>& sums);

}  // namespace vernier::phantoms
