// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/ImageMetrics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "Ssim.h"
#include "vernier/base/Guarded.h"

namespace vernier::measure {
namespace {

const char* nameOf(SampleType t) {
  return t == SampleType::U8 ? "8 bits" : t == SampleType::U16 ? "16 bits" : "floating point";
}
std::size_t bytesOf(SampleType t) { return t == SampleType::U8 ? 1 : t == SampleType::U16 ? 2 : 4; }

std::string saying(const ImageView& v) {
  return std::to_string(v.width) + " x " + std::to_string(v.height) + ", " +
         (v.channels == 1   ? "grey"
          : v.channels == 3 ? "colour"
                            : "colour with alpha") +
         ", " + nameOf(v.type);
}

std::size_t sampleCount(const ImageView& v) {
  return static_cast<std::size_t>(v.width) * static_cast<std::size_t>(v.height) *
         static_cast<std::size_t>(v.channels);
}

Result<void> check(const ImageView& v) {
  if (v.width < 1 || v.height < 1 || (v.channels != 1 && v.channels != 3 && v.channels != 4))
    return makeError(
        ErrorCode::OptionInvalid,
        "An image has at least one pixel and 1, 3 or 4 channels; this one is " + saying(v) + ".");
  if (v.samples.size() != sampleCount(v) * bytesOf(v.type))
    return makeError(ErrorCode::OptionInvalid, "The image's samples are not as many as its size says.");
  return {};
}

Result<void> checkSame(const ImageView& a, const ImageView& b) {
  if (const Result<void> r = check(a); !r) return r;
  if (const Result<void> r = check(b); !r) return r;
  const char* what = a.width != b.width || a.height != b.height ? "size"
                     : a.channels != b.channels                 ? "colour"
                     : a.type != b.type                         ? "depth"
                                                                : nullptr;
  if (what)
    return makeError(ErrorCode::OptionInvalid, std::string("The images differ in ") + what + " (" +
                                                   saying(a) + " and " + saying(b) +
                                                   "); only like can be compared.");
  return {};
}

template <class T>
std::vector<double> widened(const ImageView& v) {
  std::vector<double> out(sampleCount(v));
  for (std::size_t i = 0; i < out.size(); ++i) {
    T x;
    std::memcpy(&x, v.samples.data() + i * sizeof(T), sizeof(T));  // bytes need not be aligned
    out[i] = static_cast<double>(x);
  }
  return out;
}
std::vector<double> widened(const ImageView& v) {
  switch (v.type) {
    case SampleType::U8:
      return widened<std::uint8_t>(v);
    case SampleType::U16:
      return widened<std::uint16_t>(v);
    case SampleType::F32:
      return widened<float>(v);
  }
  return {};
}

double rangeOf(const std::vector<double>& a, const std::vector<double>& b) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const auto* image : {&a, &b})
    for (const double x : *image)
      if (!std::isnan(x)) least = std::min(least, x), most = std::max(most, x);
  return most > least ? most - least : 0;
}

// Everything but SSIM and colour differences.
void differences(const std::vector<double>& a, const std::vector<double>& b, const ImageView& view,
                 ImageMetrics& m) {
  const auto channels = static_cast<std::size_t>(view.channels);
  double sum = 0, squares = 0, signedSum = 0;
  std::size_t differing = 0, worst = 0;
  for (std::size_t pixel = 0; pixel < a.size() / channels; ++pixel) {
    bool differs = false;
    for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
      if (std::isnan(a[i]) != std::isnan(b[i])) {
        ++m.unmatched;
        differs = true;
      }
      if (std::isnan(a[i]) || std::isnan(b[i])) continue;
      ++m.compared;
      if (a[i] == b[i]) continue;  // two infinities too
      const double d = b[i] - a[i];
      differs = true;
      sum += std::abs(d), squares += d * d, signedSum += d;
      if (std::abs(d) > m.max) m.max = std::abs(d), worst = pixel;
    }
    differing += differs;
  }
  if (m.compared > 0) {
    const auto n = static_cast<double>(m.compared);
    m.mean = sum / n, m.rmse = std::sqrt(squares / n), m.bias = signedSum / n;
  }
  m.differing = static_cast<double>(differing) / static_cast<double>(a.size() / channels);
  m.worstX = static_cast<int>(worst % static_cast<std::size_t>(view.width));
  m.worstY = static_cast<int>(worst / static_cast<std::size_t>(view.width));
}

void colourDifferences(const std::vector<double>& a, const std::vector<double>& b, std::size_t channels,
                       double full, ImageMetrics& m) {
  double sum = 0, most = 0;
  const std::size_t pixels = a.size() / channels;
  for (std::size_t p = 0; p < pixels; ++p) {
    const double* x = &a[p * channels];
    const double* y = &b[p * channels];
    if (std::equal(x, x + 3, y)) continue;
    const double d = ciede2000(labFromSrgb(x[0] / full, x[1] / full, x[2] / full),
                               labFromSrgb(y[0] / full, y[1] / full, y[2] / full));
    sum += d;
    most = std::max(most, d);
  }
  m.ciede2000_mean = sum / static_cast<double>(pixels);
  m.ciede2000_max = most;
}

}  // namespace

Result<ImageMetrics> compareImages(const ImageView& va, const ImageView& vb, std::optional<double> peak) {
  return guarded("compareImages", [&]() -> Result<ImageMetrics> {
    if (const Result<void> same = checkSame(va, vb); !same) return same.error();
    if (peak && !(*peak > 0 && std::isfinite(*peak)))
      return makeError(ErrorCode::OptionInvalid, "The full range of an image is a number above 0.");
    const std::vector<double> a = widened(va), b = widened(vb);
    ImageMetrics m;
    differences(a, b, va, m);
    const double full = va.type == SampleType::U8 ? 255 : va.type == SampleType::U16 ? 65535 : 0;
    m.peak = peak ? *peak : full > 0 ? full : rangeOf(a, b);
    m.psnr_dB = m.rmse > 0 ? 20 * std::log10(m.peak / m.rmse) : std::numeric_limits<double>::infinity();
    const auto finite = [](double x) { return std::isfinite(x); };
    if (std::all_of(a.begin(), a.end(), finite) && std::all_of(b.begin(), b.end(), finite))
      m.ssim = ssim(a, b, va.width, va.height, va.channels, m.peak);
    if (va.channels >= 3 && full > 0) colourDifferences(a, b, static_cast<std::size_t>(va.channels), full, m);
    return m;
  });
}

}  // namespace vernier::measure
