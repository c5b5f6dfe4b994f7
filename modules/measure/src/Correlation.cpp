// SPDX-License-Identifier: GPL-3.0-or-later
#include "Correlation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <queue>
#include <vector>

namespace vernier::measure {
namespace {

cv::Mat spectrum(const cv::Mat& image) {
  cv::Mat out;
  cv::dft(image, out, cv::DFT_COMPLEX_OUTPUT);
  return out;
}

int signedShift(int at, int size) { return at > size / 2 ? at - size : at; }

// Sums of products of `a` and `b` shifted by every amount, without wrapping round.
cv::Mat sums(const cv::Mat& a, const cv::Mat& b) {
  const cv::Size size(cv::getOptimalDFTSize(2 * a.cols), cv::getOptimalDFTSize(2 * a.rows));
  const auto padded = [&](const cv::Mat& m) {
    cv::Mat p = cv::Mat::zeros(size, CV_64F);
    m.copyTo(p(cv::Rect(0, 0, m.cols, m.rows)));
    return spectrum(p);
  };
  cv::Mat product, out;
  cv::mulSpectrums(padded(b), padded(a), product, 0, true);
  cv::dft(product, out, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  return out;
}

// Autocorrelation of shifts -w/2..w/2, -h/2..h/2, in the middle of the result: no shift.
cv::Mat autocorrelation(const cv::Mat& image) {
  const cv::Mat ones = cv::Mat::ones(image.size(), CV_64F), squares = image.mul(image);
  const cv::Mat products = sums(image, image), here = sums(squares, ones), there = sums(ones, squares);
  const int w = image.cols / 2, h = image.rows / 2;
  cv::Mat out(2 * h + 1, 2 * w + 1, CV_64F);
  for (int dy = -h; dy <= h; ++dy)
    for (int dx = -w; dx <= w; ++dx) {
      const int x = (dx + products.cols) % products.cols, y = (dy + products.rows) % products.rows;
      const double below = std::sqrt(std::max(0.0, here.at<double>(y, x) * there.at<double>(y, x)));
      out.at<double>(dy + h, dx + w) = below > 0 ? products.at<double>(y, x) / below : 0;
    }
  return out;
}

// The lobe: whatever is reached from the middle going downhill.
cv::Mat lobeOf(const cv::Mat& surface) {
  cv::Mat lobe = cv::Mat::zeros(surface.size(), CV_8U);
  std::queue<cv::Point> open;
  const cv::Point middle(surface.cols / 2, surface.rows / 2);
  lobe.at<uchar>(middle) = 1;
  open.push(middle);
  while (!open.empty()) {
    const cv::Point p = open.front();
    open.pop();
    for (const cv::Point d : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point q = p + d;
      if (q.x < 0 || q.y < 0 || q.x >= surface.cols || q.y >= surface.rows || lobe.at<uchar>(q)) continue;
      if (surface.at<double>(q) > surface.at<double>(p)) continue;
      lobe.at<uchar>(q) = 1;
      open.push(q);
    }
  }
  return lobe;
}

}  // namespace

PhaseCorrelation phaseCorrelation(const cv::Mat& fixed, const cv::Mat& moving) {
  cv::Mat window;
  cv::createHanningWindow(window, fixed.size(), CV_64F);
  cv::Mat cross;
  cv::mulSpectrums(spectrum(moving.mul(window)), spectrum(fixed.mul(window)), cross, 0, true);
  double most = 0;
  for (int y = 0; y < cross.rows; ++y)
    for (int x = 0; x < cross.cols; ++x) most = std::max(most, cv::norm(cross.at<cv::Vec2d>(y, x)));
  // Frequencies without signal would all count alike and drown the others.
  const double damping = 1e-3 * most + 1e-300;
  for (int y = 0; y < cross.rows; ++y)
    for (int x = 0; x < cross.cols; ++x) {
      cv::Vec2d& v = cross.at<cv::Vec2d>(y, x);
      v /= cv::norm(v) + damping;
    }
  cv::Mat surface;
  cv::dft(cross, surface, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  PhaseCorrelation out;
  cv::Point low, high;
  cv::minMaxLoc(surface, &out.lowest.value, &out.best.value, &low, &high);
  cv::Scalar mean, sd;
  cv::meanStdDev(surface, mean, sd);
  out.noise = sd[0];
  out.best.dx = signedShift(high.x, surface.cols), out.best.dy = signedShift(high.y, surface.rows);
  out.lowest.dx = signedShift(low.x, surface.cols), out.lowest.dy = signedShift(low.y, surface.rows);
  return out;
}

double selfLikeness(const cv::Mat& image) {
  cv::Mat smooth;  // noise makes a maximum of every other pixel
  cv::GaussianBlur(image, smooth, cv::Size(5, 5), 1);
  const cv::Mat surface = autocorrelation(smooth), lobe = lobeOf(surface);
  double most = 0;
  for (int y = 1; y + 1 < surface.rows; ++y)
    for (int x = 1; x + 1 < surface.cols; ++x) {
      if (lobe.at<uchar>(y, x)) continue;
      const double v = surface.at<double>(y, x);
      bool top = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) top = top && surface.at<double>(y + dy, x + dx) <= v;
      if (top) most = std::max(most, v);
    }
  return most;
}

}  // namespace vernier::measure
