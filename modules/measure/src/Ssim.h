// SPDX-License-Identifier: GPL-3.0-or-later
// Structural similarity; ImageMetrics.h has the source.
#pragma once
#include <optional>
#include <vector>

namespace vernier::measure {

inline constexpr int kSsimWindow = 11;

// Finite samples, channels interleaved. nullopt: smaller than the window. A range of 0 (both images constant
// and equal) gives 1.
std::optional<double> ssim(const std::vector<double>& a, const std::vector<double>& b, int width, int height,
                           int channels, double range);

}  // namespace vernier::measure
