// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/RayIntervals.h"

namespace vernier {

float RayIntervals::lightBefore(std::size_t pixel, std::size_t segment) const {
  float light = 1;
  for (std::size_t n = first[pixel]; n < segment; ++n) light *= segments[n].through;
  return light;
}

RayRound roundOf(const RayIntervals& rays, const RaysOfPass& pass, int round) {
  const std::size_t pixels = rays.first.size() - 1;
  RayRound out;
  out.from_mm.assign(pixels, 1.0f), out.to_mm.assign(pixels, 0.0f);
  out.segment.assign(pixels, -1);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    int n = 0;
    eachSegment(rays, pixel, pass, [&](std::size_t index) {
      if (n++ != round) return;
      out.from_mm[pixel] = rays.segments[index].from_mm, out.to_mm[pixel] = rays.segments[index].to_mm;
      out.segment[pixel] = static_cast<std::int32_t>(index);
      out.any = true;
    });
  }
  return out;
}

}  // namespace vernier
