// SPDX-License-Identifier: GPL-3.0-or-later
// The one place where float colours become 8 bits, for PNG, window and DICOM alike: floor(255 x + 0.5) after
// clamping to 0..1. A pixel with NaN in red, green or blue becomes the marker colour, magenta, so that a
// fault is seen. The alpha of a frame is not stored: frames are opaque, their background is drawn already.
// Runs on all threads; the result does not depend on how many.
#pragma once
#include <cmath>

#include "vernier/base/Api.h"
#include "vernier/picture/Picture.h"
#include "vernier/plan/Frame.h"

namespace vernier {

inline constexpr Rgb8 kMarker{255, 0, 255};

// x is not NaN.
inline std::uint8_t quantise(float x) {
  const double clamped = x <= 0 ? 0.0 : x >= 1 ? 1.0 : static_cast<double>(x);
  return static_cast<std::uint8_t>(std::floor(255.0 * clamped + 0.5));
}

// `reuse` gives its memory to the result.
VERNIER_API Picture quantise(const Images&, Picture reuse = {});

}  // namespace vernier
