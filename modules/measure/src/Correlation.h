// SPDX-License-Identifier: GPL-3.0-or-later
// Correlation surfaces of two grey images of one size.
#pragma once
#include <opencv2/core.hpp>

namespace vernier::measure {

struct Peak {
  double value = 0;
  int dx = 0, dy = 0;  // whole pixels, -size/2 .. size/2
};
struct PhaseCorrelation {
  Peak best, lowest;
  double noise = 0;  // SD of the surface
};
// CV_64F, zero mean. Where `moving` must be looked at, relative to `fixed`.
PhaseCorrelation phaseCorrelation(const cv::Mat& fixed, const cv::Mat& moving);

// How much an image resembles itself elsewhere: the largest local maximum of its autocorrelation (each shift
// over what overlaps, up to half the image, -1..1) outside the lobe around no shift. 0: nowhere.
double selfLikeness(const cv::Mat& image);

}  // namespace vernier::measure
