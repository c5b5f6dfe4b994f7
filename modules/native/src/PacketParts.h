// SPDX-License-Identifier: GPL-3.0-or-later
// The parts that a pass draws of the rays of one packet (RayIntervals.h).
#pragma once
#include <array>

#include "VolumeFast.h"
#include "vernier/plan/RayIntervals.h"

namespace vernier::native {

inline bool meetsLens(const RayIntervals& rays, int x0, int y0) {
  for (int y = y0; y < std::min(y0 + kPacketEdge_px, rays.height); ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(rays.width);
    const std::size_t begin = row + static_cast<std::size_t>(x0),
                      end = row + static_cast<std::size_t>(std::min(x0 + kPacketEdge_px, rays.width));
    if (rays.first[begin] != rays.first[end]) return true;
  }
  return false;
}

class PacketParts {
 public:
  PacketParts(RayIntervals& rays, const RaysOfPass& pass, int x0, int y0)
      : rays_(rays), pass_(pass), x0_(x0), y0_(y0) {
    for (int n = 0; n < kPacketRays; ++n)
      if (inPicture(n)) eachSegment(rays_, pixel(n), pass_, [&](std::size_t) { ++parts_; });
  }
  bool none() const { return parts_ == 0; }

  // The rays' parts of the round become those of the packet; a ray without one, or without light, is empty.
  // False when no ray has any.
  bool next(int round, RayPacket& packet, double leastLight) {
    bool any = false;
    for (int n = 0; n < kPacketRays; ++n) {
      segment_[static_cast<std::size_t>(n)] = nullptr;
      packet.to_mm[n] = packet.from_mm[n] - 1;
      if (!inPicture(n)) continue;
      int at = 0;
      eachSegment(rays_, pixel(n), pass_, [&](std::size_t index) {
        if (at++ != round) return;
        any = true;
        const double light = static_cast<double>(rays_.lightBefore(pixel(n), index));
        if (light < leastLight) return;
        RaySegment& s = rays_.segments[index];
        before_[static_cast<std::size_t>(n)] = light;
        segment_[static_cast<std::size_t>(n)] = &s;
        packet.from_mm[n] = static_cast<double>(s.from_mm), packet.to_mm[n] = static_cast<double>(s.to_mm);
      });
    }
    return any;
  }
  RaySegment* segment(int n) const { return segment_[static_cast<std::size_t>(n)]; }
  double before(int n) const { return segment(n) ? before_[static_cast<std::size_t>(n)] : 1; }

  static void put(RaySegment& s, const RayLight& light, double before) {
    for (int c = 0; c < 3; ++c)
      s.colour[static_cast<std::size_t>(c)] = static_cast<float>(light.colour[c] / before);
    s.through = static_cast<float>(light.through / before);
    s.hasDepth = std::isfinite(light.half_mm);
    s.depth_mm = s.hasDepth ? static_cast<float>(light.half_mm) : 0;
  }

 private:
  bool inPicture(int n) const {
    return x0_ + n % kPacketEdge_px < rays_.width && y0_ + n / kPacketEdge_px < rays_.height;
  }
  std::size_t pixel(int n) const {
    return static_cast<std::size_t>(x0_ + n % kPacketEdge_px) +
           static_cast<std::size_t>(rays_.width) * static_cast<std::size_t>(y0_ + n / kPacketEdge_px);
  }
  RayIntervals& rays_;
  const RaysOfPass pass_;
  const int x0_, y0_;
  int parts_ = 0;
  std::array<RaySegment*, kPacketRays> segment_{};
  std::array<double, kPacketRays> before_{};
};

}  // namespace vernier::native
