// SPDX-License-Identifier: GPL-3.0-or-later
// Words of the file that stand for values.
#pragma once
#include <string>

#include "vernier/measure/Measurement.h"

namespace vernier::measure {

inline constexpr const char* kShownWords[] = {"slice", "slab", "projection", "rendering"};
inline const char* wordOf(Shown s) { return kShownWords[static_cast<std::size_t>(s)]; }
inline const char* wordOf(Space s) { return s == Space::Image ? "image" : "patient"; }

}  // namespace vernier::measure
