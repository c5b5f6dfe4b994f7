// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Compare.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

namespace vernier {
namespace {

std::string sizeOf(const Picture& p) {
  return std::to_string(p.width) + " x " + std::to_string(p.height) + " x " + std::to_string(p.channels);
}

Result<void> checkSame(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels ||
      a.pixels.size() != b.pixels.size())
    return makeError(ErrorCode::OptionInvalid,
                     "The pictures differ in size (" + sizeOf(a) + " and " + sizeOf(b) +
                         ", width x height x channels); only equal sizes can be compared.");
  if (a.pixels.empty()) return makeError(ErrorCode::OptionInvalid, "The pictures have no pixels to compare.");
  return {};
}

int pixelDifference(const Picture& a, const Picture& b, std::size_t pixel) {
  const auto n = static_cast<std::size_t>(a.channels);
  int d = 0;
  for (std::size_t k = pixel * n; k < (pixel + 1) * n; ++k)
    d = std::max(d, std::abs(a.pixels[k] - b.pixels[k]));
  return d;
}

Rgb8 heat(int difference) {
  if (difference == 0) return {};
  constexpr double stops[][3] = {{0, 0, 96},    {0, 64, 255}, {0, 200, 120},
                                 {255, 230, 0}, {255, 40, 0}, {255, 255, 255}};
  const double t = std::log2(1.0 + difference) / 8 * 5;
  const int i = std::min(static_cast<int>(t), 4);
  std::uint8_t c[3];
  for (int k = 0; k < 3; ++k)
    c[k] = static_cast<std::uint8_t>(std::lround(stops[i][k] + (t - i) * (stops[i + 1][k] - stops[i][k])));
  return {c[0], c[1], c[2]};
}

}  // namespace

Result<Difference> comparePictures(const Picture& a, const Picture& b) {
  if (Result<void> same = checkSame(a, b); !same) return same.error();
  Difference d;
  std::uint64_t sum = 0, squares = 0, differing = 0;
  for (std::size_t k = 0; k < a.pixels.size(); ++k) {
    const auto e = static_cast<std::uint64_t>(std::abs(a.pixels[k] - b.pixels[k]));
    sum += e;
    squares += e * e;
  }
  const std::size_t pixels = a.pixels.size() / static_cast<std::size_t>(a.channels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const int e = pixelDifference(a, b, i);
    differing += e > 0;
    if (e > d.max) {
      d.max = e;
      d.worstX = static_cast<int>(i % static_cast<std::size_t>(a.width));
      d.worstY = static_cast<int>(i / static_cast<std::size_t>(a.width));
    }
  }
  const auto samples = static_cast<double>(a.pixels.size());
  d.mean = static_cast<double>(sum) / samples;
  d.rmse = std::sqrt(static_cast<double>(squares) / samples);
  d.differing = static_cast<double>(differing) / static_cast<double>(pixels);
  return d;
}

Result<std::array<std::uint64_t, 256>> differenceHistogram(const Picture& a, const Picture& b) {
  if (const Result<void> r = checkSame(a, b); !r) return r.error();
  std::array<std::uint64_t, 256> n{};
  const std::size_t pixels = a.pixels.size() / static_cast<std::size_t>(a.channels);
  for (std::size_t i = 0; i < pixels; ++i) ++n[static_cast<std::size_t>(pixelDifference(a, b, i))];
  return n;
}

Result<Picture> heatmap(const Picture& a, const Picture& b) {
  if (Result<void> same = checkSame(a, b); !same) return same.error();
  Picture out(a.width, a.height);
  for (std::size_t i = 0; i < out.pixels.size() / 3; ++i) {
    const Rgb8 c = heat(pixelDifference(a, b, i));
    out.pixels[3 * i] = c.r, out.pixels[3 * i + 1] = c.g, out.pixels[3 * i + 2] = c.b;
  }
  return out;
}

}  // namespace vernier
