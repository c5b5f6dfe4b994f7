// SPDX-License-Identifier: GPL-3.0-or-later
// One image object as a DICOM Part 10 file.
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "Plan.h"
#include "vernier/base/Result.h"

namespace vernier::phantoms {

Result<void> writeDicom(const StudyPlan&, const SeriesPlan&, const SlicePlan&,
                        const std::vector<std::int32_t>& stored, const std::filesystem::path& file);

// The SOP Class of a storage.
const char* classOf(Storage);

// The study's presentation state.
Result<void> writePresentation(const StudyPlan&, const PresentationPlan&, const std::filesystem::path& file);

}  // namespace vernier::phantoms
