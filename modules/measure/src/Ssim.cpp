// SPDX-License-Identifier: GPL-3.0-or-later
#include "Ssim.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace vernier::measure {
namespace {

// Weighted means of every window that lies wholly inside.
cv::Mat windowed(const cv::Mat& image) {
  cv::Mat out;
  cv::GaussianBlur(image, out, cv::Size(kSsimWindow, kSsimWindow), 1.5, 1.5, cv::BORDER_REFLECT_101);
  constexpr int kBorder = kSsimWindow / 2;
  return out(cv::Rect(kBorder, kBorder, image.cols - 2 * kBorder, image.rows - 2 * kBorder));
}

double ofChannel(const cv::Mat& a, const cv::Mat& b, double c1, double c2) {
  const cv::Mat ma = windowed(a), mb = windowed(b);
  const cv::Mat aa = windowed(a.mul(a)), bb = windowed(b.mul(b)), ab = windowed(a.mul(b));
  double sum = 0;
  for (int y = 0; y < ma.rows; ++y)
    for (int x = 0; x < ma.cols; ++x) {
      const double p = ma.at<double>(y, x), q = mb.at<double>(y, x);
      const double covariance = ab.at<double>(y, x) - p * q;
      const double variances = (aa.at<double>(y, x) - p * p) + (bb.at<double>(y, x) - q * q);
      const double below = (p * p + q * q + c1) * (variances + c2);
      sum += below == 0 ? 1 : (2 * p * q + c1) * (2 * covariance + c2) / below;
    }
  return sum / (static_cast<double>(ma.rows) * ma.cols);
}

}  // namespace

std::optional<double> ssim(const std::vector<double>& a, const std::vector<double>& b, int width, int height,
                           int channels, double range) {
  if (width < kSsimWindow || height < kSsimWindow) return {};
  const double c1 = (0.01 * range) * (0.01 * range), c2 = (0.03 * range) * (0.03 * range);
  double sum = 0;
  for (int c = 0; c < channels; ++c) {
    cv::Mat ma(height, width, CV_64F), mb(height, width, CV_64F);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto i =
            (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
                static_cast<std::size_t>(channels) +
            static_cast<std::size_t>(c);
        ma.at<double>(y, x) = a[i];
        mb.at<double>(y, x) = b[i];
      }
    sum += ofChannel(ma, mb, c1, c2);
  }
  return sum / channels;
}

}  // namespace vernier::measure
