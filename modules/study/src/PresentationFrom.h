// SPDX-License-Identifier: GPL-3.0-or-later
// Header -> PresentationState. What is missing or wrong is absent, and said in notApplied where it would be
// seen.
#pragma once
#include <optional>

#include "Header.h"
#include "vernier/study/Presentation.h"

namespace vernier {

// nullopt: the object is no presentation state.
std::optional<PresentationState> presentationFrom(const Header&);

}  // namespace vernier
