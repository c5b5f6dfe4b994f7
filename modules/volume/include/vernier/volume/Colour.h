// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of stored pixels, display-referred sRGB-coded numbers 0..1, in double. Sources: DICOM PS3.3
// C.7.6.3.1.2 (YBR_FULL, YBR_PARTIAL), C.7.6.3.1.5 (palettes). Pure functions.
#pragma once
#include <array>
#include <glm/glm.hpp>

#include "vernier/base/Api.h"
#include "vernier/study/FrameSpec.h"
#include "vernier/study/Palette.h"

namespace vernier {

// `samples`: of one pixel as stored; of a palette image the index alone. `bits`: stored bits of a sample.
// `palette` is needed for ColourSpace::Palette only. Values that YBR gives outside of 0..1 are clamped.
VERNIER_API glm::dvec3 rgbOf(ColourSpace, const std::array<double, 3>& samples, std::uint32_t bits,
                             const Palette* palette = nullptr);

}  // namespace vernier
