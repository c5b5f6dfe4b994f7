// SPDX-License-Identifier: GPL-3.0-or-later
// A stack of colour images becomes a colour volume of red, green and blue, 8 bits each.
#pragma once
#include "vernier/volume/Build.h"

namespace vernier {

// Whether the first usable slice is in colour.
bool isColourStack(const StudySet&, const Stack&);

// As buildVolume(); NotBuiltYet for colours of more than 8 bits other than palettes.
Result<std::shared_ptr<const Volume>> buildColourVolume(const StudySet&, const Series&, const Stack&,
                                                        const BuildOptions&, const ProgressFn&,
                                                        std::stop_token);

}  // namespace vernier
