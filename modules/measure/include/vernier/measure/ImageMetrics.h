// SPDX-License-Identifier: GPL-3.0-or-later
// How far two images are apart. Images of different size, depth or number of channels are refused
// (OptionInvalid), never converted; identical images give exactly 0 (SSIM exactly 1, PSNR infinite). Computed
// in double. Pure functions, safe on any thread.
//
// All channels count alike. NaN of a float image is no-data: a sample that both images have is compared, one
// that only one of them has is counted in `unmatched`.
// SSIM: Wang, Bovik, Sheikh and Simoncelli 2004, IEEE TIP 13(4), eq. 13 with K1 = 0.01 and K2 = 0.03,
// Gaussian window of 11 x 11 and sigma 1.5, mean over the windows that lie wholly inside and over the
// channels. CIEDE2000: Sharma, Wu and Dalal 2005, Color Res. Appl. 30(1), eq. 2 to 22, kL = kC = kH = 1, of
// numbers that are sRGB-coded (IEC 61966-2-1) with white D65.
#pragma once
#include <cstddef>
#include <optional>
#include <span>

#include "vernier/base/Result.h"

namespace vernier::measure {

enum class SampleType { U8, U16, F32 };

// Samples of the machine's own byte order, channels interleaved, row 0 on top, no padding. Does not own them.
struct ImageView {
  int width = 0, height = 0;
  int channels = 1;  // 1 grey, 3 red green blue, 4 and alpha
  SampleType type = SampleType::U8;
  std::span<const std::byte> samples;
};

struct ImageMetrics {
  std::size_t compared = 0;            // samples that both have
  std::size_t unmatched = 0;           // samples that only one has
  double max = 0, mean = 0, rmse = 0;  // of absolute differences, in the samples' own unit
  double bias = 0;                     // mean of b - a
  double differing = 0;                // share of the pixels that differ in any channel, 0..1
  int worstX = 0, worstY = 0;          // the first pixel with the largest difference
  double peak = 0;                     // what PSNR and SSIM count as the full range
  double psnr_dB = 0;                  // infinite when nothing differs
  std::optional<double> ssim;          // absent: smaller than 11 x 11, or no-data inside
  std::optional<double> ciede2000_mean, ciede2000_max;  // of U8 and U16 with 3 or 4 channels, without alpha
};

// `peak`: full range of the samples; absent: 255, 65535, or of float images the range of all samples of both.
VERNIER_API Result<ImageMetrics> compareImages(const ImageView& a, const ImageView& b,
                                               std::optional<double> peak = {});

struct Lab {
  double L = 0, a = 0, b = 0;
};
VERNIER_API double ciede2000(const Lab&, const Lab&);
// r, g, b: 0..1, sRGB-coded.
VERNIER_API Lab labFromSrgb(double r, double g, double b);

}  // namespace vernier::measure
