// SPDX-License-Identifier: GPL-3.0-or-later
// How far two 8-bit pictures are apart, in levels of 255. All channels count alike; identical pictures give
// exactly 0. Pictures of different size or number of channels are refused (OptionInvalid), never resampled.
#pragma once
#include <array>
#include <cstdint>

#include "vernier/base/Result.h"
#include "vernier/picture/Picture.h"

namespace vernier {

struct Difference {
  int max = 0;      // largest of all channels and pixels
  double mean = 0;  // of absolute differences
  double rmse = 0;
  double differing = 0;        // share of the pixels that differ in any channel, 0..1
  int worstX = 0, worstY = 0;  // the first pixel with the largest difference
};

VERNIER_API Result<Difference> comparePictures(const Picture& a, const Picture& b);

// How many pixels have which largest channel difference.
VERNIER_API Result<std::array<std::uint64_t, 256>> differenceHistogram(const Picture& a, const Picture& b);

// Each pixel's largest channel difference as a colour: 0 black, then log2(1 + d) / 8 from blue over green and
// yellow to white at 255, the same for all pictures so that heatmaps can be compared.
VERNIER_API Result<Picture> heatmap(const Picture& a, const Picture& b);

}  // namespace vernier
