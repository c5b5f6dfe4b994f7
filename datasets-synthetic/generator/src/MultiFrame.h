// SPDX-License-Identifier: GPL-3.0-or-later
// Multi-frame objects of a recipe's "multi_frame": Enhanced CT and MR instead of single slices; a
// segmentation or a dose beside them. Planning is pure; writing samples what it needs.
#pragma once
#include <filesystem>
#include <functional>

#include "Plan.h"
#include "vernier/base/Result.h"

namespace vernier::phantoms {

// Turns the first series into multi-frame objects where the recipe asks for that.
void makeMultiFrame(const Json& recipe, const std::function<std::string(const std::string&)>& uid,
                    StudyPlan& study);

// One object of a series; stored[k] are the values of slice k.
Result<void> writeEnhanced(const StudyPlan&, const SeriesPlan&, std::size_t object,
                           const std::vector<std::vector<std::int32_t>>& stored,
                           const std::filesystem::path& folder);

// Writes the segmentation or dose that lies beside the first series and returns its answers; null without
// one.
Result<Json> writeBeside(const Json& recipe, const std::string& variant, const StudyPlan&,
                         const std::filesystem::path& folder);

}  // namespace vernier::phantoms
