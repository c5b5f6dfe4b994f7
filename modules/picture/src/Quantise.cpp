// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Quantise.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "vernier/base/Threads.h"

namespace vernier {
namespace {

constexpr std::size_t kRun = 256;

void quantiseAny(const float* in, std::size_t n, std::uint8_t* to) {
  for (std::size_t i = 0; i < n; ++i, in += 4, to += 3) {
    if (std::isnan(in[0]) || std::isnan(in[1]) || std::isnan(in[2]))
      to[0] = kMarker.r, to[1] = kMarker.g, to[2] = kMarker.b;
    else
      to[0] = quantise(in[0]), to[1] = quantise(in[1]), to[2] = quantise(in[2]);
  }
}

// Runs of grey, which slices consist of, are converted once instead of three times, in loops that the
// compiler turns into vector code; the numbers are those of quantise(). A NaN is not equal to itself, so it
// is not grey.
void quantiseRun(const float* in, std::size_t n, std::uint8_t* to) {
  float grey[kRun];
  bool allGrey = true;
  for (std::size_t i = 0; i < n; ++i) {
    grey[i] = in[4 * i];
    allGrey &= (in[4 * i] == in[4 * i + 1]) & (in[4 * i] == in[4 * i + 2]);
  }
  if (!allGrey) return quantiseAny(in, n, to);
  std::int32_t level[kRun];
  for (std::size_t i = 0; i < n; ++i) {
    const float low = grey[i] > 0.0f ? grey[i] : 0.0f;
    const float clamped = low < 1.0f ? low : 1.0f;
    level[i] =
        static_cast<std::int32_t>(255.0 * static_cast<double>(clamped) + 0.5);  // not negative: cut is floor
  }
  for (std::size_t i = 0; i < n; ++i)
    to[3 * i] = to[3 * i + 1] = to[3 * i + 2] = static_cast<std::uint8_t>(level[i]);
}

}  // namespace

Picture quantise(const Images& images, Picture reuse) {
  Picture out = std::move(reuse);
  out.channels = 3;
  out.width = images.width;
  out.height = images.height;
  const std::size_t n = images.colour.size() / 4;
  out.pixels.resize(3 * n);
  parallelFor(n, 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; i += kRun)
      quantiseRun(&images.colour[4 * i], std::min(kRun, end - i), &out.pixels[3 * i]);
  });
  return out;
}

}  // namespace vernier
