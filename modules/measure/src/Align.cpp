// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Align.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "Correlation.h"
#include "vernier/base/Guarded.h"

namespace vernier::measure {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLeastCorrelation = 0.5;  // below it the images do not show the same
constexpr double kSelfLike = 0.8;          // above it an image lies on itself elsewhere as well

Error refused(const char* sentence) { return makeError(ErrorCode::OptionInvalid, sentence, "alignment"); }

template <class T>
void addChannel(const ImageView& v, cv::Mat& grey) {
  for (int y = 0; y < v.height; ++y)
    for (int x = 0; x < v.width; ++x) {
      double sum = 0;
      const int colours = std::min(v.channels, 3);  // without alpha
      for (int c = 0; c < colours; ++c) {
        T s;
        const auto at =
            (static_cast<std::size_t>(y) * static_cast<std::size_t>(v.width) + static_cast<std::size_t>(x)) *
                static_cast<std::size_t>(v.channels) +
            static_cast<std::size_t>(c);
        std::memcpy(&s, v.samples.data() + at * sizeof(T), sizeof(T));
        sum += static_cast<double>(s);
      }
      grey.at<double>(y, x) = sum / colours;
    }
}
cv::Mat greyOf(const ImageView& v) {
  cv::Mat grey(v.height, v.width, CV_64F);
  switch (v.type) {
    case SampleType::U8:
      addChannel<std::uint8_t>(v, grey);
      break;
    case SampleType::U16:
      addChannel<std::uint16_t>(v, grey);
      break;
    case SampleType::F32:
      addChannel<float>(v, grey);
      break;
  }
  return grey;
}

// Zero mean and SD 1; empty when there is no contrast (or no number).
cv::Mat normalised(const cv::Mat& grey) {
  cv::Scalar mean, sd;
  cv::meanStdDev(grey, mean, sd);
  const double scale = std::max({1e-12, std::abs(mean[0]) * 1e-9});
  if (!(sd[0] > scale)) return {};
  return (grey - mean) / sd[0];
}

// Linear in double; false outside.
bool sample(const cv::Mat& m, double x, double y, double& out) {
  if (!(x >= 0 && y >= 0 && x <= m.cols - 1 && y <= m.rows - 1)) return false;
  const int i = std::min(static_cast<int>(x), m.cols - 2), j = std::min(static_cast<int>(y), m.rows - 2);
  const double u = x - i, v = y - j;
  out = (1 - v) * ((1 - u) * m.at<double>(j, i) + u * m.at<double>(j, i + 1)) +
        v * ((1 - u) * m.at<double>(j + 1, i) + u * m.at<double>(j + 1, i + 1));
  return true;
}

void stateResidual(const cv::Mat& fixed, const cv::Mat& moving, const ImageView& view, Alignment& a) {
  double n = 0, f = 0, m = 0, ff = 0, mm = 0, fm = 0, squares = 0;
  for (int y = 0; y < fixed.rows; ++y)
    for (int x = 0; x < fixed.cols; ++x) {
      const ImagePoint p = movingFromFixed(a, view, {static_cast<double>(x), static_cast<double>(y)});
      double q = 0;
      if (!sample(moving, p.x, p.y, q)) continue;
      const double g = fixed.at<double>(y, x);
      n += 1, f += g, m += q, ff += g * g, mm += q * q, fm += g * q, squares += (g - q) * (g - q);
    }
  a.overlap = n / (static_cast<double>(fixed.rows) * fixed.cols);
  if (n < 2) return;
  a.residualRms = std::sqrt(squares / n);
  const double vf = ff / n - f / n * (f / n), vm = mm / n - m / n * (m / n);
  a.correlation = vf > 0 && vm > 0 ? (fm / n - f / n * (m / n)) / std::sqrt(vf * vm) : 0;
}

Result<void> check(const ImageView& a, const ImageView& b) {
  // The same refusals as of a comparison: size, depth, colour, missing samples.
  if (const Result<ImageMetrics> m = compareImages(a, b); !m) return m.error();
  if (a.width < kLeastAlignable_px || a.height < kLeastAlignable_px)
    return refused("The images are too small to be aligned; both sides need 32 pixels.");
  return {};
}

Alignment alignmentOf(const cv::Mat& warp, const ImageView& view) {
  Alignment a;
  const double c = warp.at<float>(0, 0), s = warp.at<float>(1, 0);
  a.rotation_deg = std::atan2(s, c) / kDegree;
  const double mx = (view.width - 1) / 2.0, my = (view.height - 1) / 2.0;
  const double turn = std::atan2(s, c);
  a.dx_px = std::cos(turn) * mx - std::sin(turn) * my + warp.at<float>(0, 2) - mx;
  a.dy_px = std::sin(turn) * mx + std::cos(turn) * my + warp.at<float>(1, 2) - my;
  return a;
}

Result<Alignment> aligned(const ImageView& fv, const ImageView& mv) {
  if (const Result<void> r = check(fv, mv); !r) return r.error();
  const cv::Mat fixed = greyOf(fv), moving = greyOf(mv);
  if (!cv::checkRange(fixed) || !cv::checkRange(moving))
    return refused(
        "The images hold pixels without data; images are aligned only where all of both is known.");
  const cv::Mat f = normalised(fixed), m = normalised(moving);
  if (f.empty() || m.empty()) return refused("An image is flat: nothing in it says where it lies.");
  const PhaseCorrelation phase = phaseCorrelation(f, m);
  if (-phase.lowest.value > phase.best.value)
    return refused("The images have opposite contrast; invert one of them first.");
  if (selfLikeness(f) > kSelfLike || selfLikeness(m) > kSelfLike)
    return refused("An image repeats itself, so the images lie on each other in several places.");
  cv::Mat f32, m32;
  f.convertTo(f32, CV_32F);
  m.convertTo(m32, CV_32F);
  cv::Mat warp = cv::Mat::eye(2, 3, CV_32F);
  warp.at<float>(0, 2) = static_cast<float>(phase.best.dx);
  warp.at<float>(1, 2) = static_cast<float>(phase.best.dy);
  try {
    cv::findTransformECC(f32, m32, warp, cv::MOTION_EUCLIDEAN,
                         cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-8),
                         cv::noArray(), 5);
  } catch (const cv::Exception&) {
    return refused("The images do not show the same thing: no place was found where they lie on each other.");
  }
  Alignment a = alignmentOf(warp, fv);
  stateResidual(fixed, moving, fv, a);
  if (!(a.correlation >= kLeastCorrelation) || a.overlap < 0.25)
    return refused("The images do not show the same thing: no place was found where they lie on each other.");
  return a;
}

}  // namespace

Result<Alignment> alignRigid(const ImageView& fixed, const ImageView& moving) {
  return guarded("alignRigid", [&] { return aligned(fixed, moving); });
}

ImagePoint movingFromFixed(const Alignment& a, const ImageView& fixed, ImagePoint p) {
  const double mx = (fixed.width - 1) / 2.0, my = (fixed.height - 1) / 2.0;
  const double c = std::cos(a.rotation_deg * kDegree), s = std::sin(a.rotation_deg * kDegree);
  const double x = p.x - mx, y = p.y - my;
  return {c * x - s * y + mx + a.dx_px, s * x + c * y + my + a.dy_px};
}

Result<std::vector<std::uint8_t>> warpedForDisplay(const ImageView& v, const Alignment& a) {
  return guarded("warpedForDisplay", [&]() -> Result<std::vector<std::uint8_t>> {
    if (v.type != SampleType::U8)
      return makeError(ErrorCode::OptionInvalid, "Only 8-bit pictures are laid on each other for the eye.");
    if (const Result<ImageMetrics> whole = compareImages(v, v); !whole) return whole.error();
    const ImagePoint o = movingFromFixed(a, v, {0, 0});
    const double c = std::cos(a.rotation_deg * kDegree), s = std::sin(a.rotation_deg * kDegree);
    const cv::Mat warp = (cv::Mat_<double>(2, 3) << c, -s, o.x, s, c, o.y);
    const cv::Mat from(v.height, v.width, CV_8UC(v.channels),
                       const_cast<std::byte*>(v.samples.data()));  // read only
    std::vector<std::uint8_t> out(v.samples.size());
    cv::Mat to(v.height, v.width, CV_8UC(v.channels), out.data());
    cv::warpAffine(from, to, warp, to.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT);
    return out;
  });
}

}  // namespace vernier::measure
