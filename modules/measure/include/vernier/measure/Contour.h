// SPDX-License-Identifier: GPL-3.0-or-later
// The outer outline of the pixels that reach a level and hang together (by edges or corners) with a seed.
// OpenCV follows the border from pixel to pixel; the outline then runs where the value, linear between the
// centres of a border pixel and each of its four neighbours outside, passes the level (as marching squares
// has it), so that it is finer than a pixel. Beyond the image nothing is known: there the outline runs along
// the outermost centres.
#pragma once
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "vernier/base/Result.h"

namespace vernier::measure {

// value(i, j), NaN for no data, which reaches no level. The outline in pixels, the centre of the first one at
// 0.5, 0.5. OptionInvalid when the seed is outside of the image or below the level, or the image is
// larger than 32767 pixels either way (OpenCV's own limit).
VERNIER_API Result<std::vector<glm::dvec2>> thresholdContour(
    std::int64_t columns, std::int64_t rows, const std::function<double(std::int64_t, std::int64_t)>& value,
    double level, std::int64_t seedColumn, std::int64_t seedRow);

}  // namespace vernier::measure
