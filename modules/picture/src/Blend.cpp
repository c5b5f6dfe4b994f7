// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Blend.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "vernier/picture/Compare.h"

namespace vernier {
namespace {

constexpr Rgb8 kSeam{255, 230, 0};

Result<void> alike(const Picture& a, const Picture& b) {
  const Result<Difference> d = comparePictures(a, b);  // says what is wrong
  if (!d) return d.error();
  return {};
}

template <class Choose>
Picture chosen(const Picture& a, const Picture& b, Choose&& takesB) {
  Picture out = a;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      if (takesB(x, y)) std::copy_n(b.at(x, y), b.channels, out.at(x, y));
  return out;
}

}  // namespace

Result<Picture> wipe(const Picture& a, const Picture& b, double position) {
  if (const Result<void> r = alike(a, b); !r) return r.error();
  if (!(position >= 0 && position <= 1))
    return makeError(ErrorCode::OptionInvalid, "The place of a wipe is a number from 0 to 1.");
  const int seam = static_cast<int>(std::lround(position * a.width));
  Picture out = chosen(a, b, [&](int x, int) { return x >= seam; });
  if (seam > 0 && seam < a.width)
    for (int y = 0; y < a.height; ++y) {
      std::uint8_t* p = out.at(seam, y);
      p[0] = kSeam.r, p[1] = kSeam.g, p[2] = kSeam.b;
    }
  return out;
}

Result<Picture> checkerboard(const Picture& a, const Picture& b, int tile_px) {
  if (const Result<void> r = alike(a, b); !r) return r.error();
  if (tile_px < 1) return makeError(ErrorCode::OptionInvalid, "A square has at least one pixel.");
  return chosen(a, b, [&](int x, int y) { return (x / tile_px + y / tile_px) % 2 == 1; });
}

Result<Picture> signedDifference(const Picture& a, const Picture& b) {
  if (const Result<void> r = alike(a, b); !r) return r.error();
  Picture out(a.width, a.height);
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const std::uint8_t *p = a.at(x, y), *q = b.at(x, y);
      int most = 0, sum = 0;
      for (int c = 0; c < a.channels; ++c) most = std::max(most, std::abs(q[c] - p[c]));
      for (int c = 0; c < 3; ++c) sum += q[c] - p[c];
      const double share = std::sqrt(std::min(1.0, static_cast<double>(most) / kFullColour));
      const double under = 0.25 * (p[0] + p[1] + p[2]) / 3 * (1 - share);
      constexpr double kBrighter[] = {255, 140, 0}, kDarker[] = {0, 130, 255}, kOther[] = {200, 200, 200};
      const double* colour = sum > 0 ? kBrighter : sum < 0 ? kDarker : kOther;
      for (int c = 0; c < 3; ++c)
        out.at(x, y)[c] = static_cast<std::uint8_t>(std::lround(under + share * colour[c]));
    }
  return out;
}

}  // namespace vernier
