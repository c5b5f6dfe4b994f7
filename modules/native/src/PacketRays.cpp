// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "PacketRays.h"

namespace vernier::native {

PacketRays::PacketRays(const CameraPicture& camera, const std::vector<HalfSpace>& region,
                       const Volume& volume)
    : camera_(camera), region_(region), voxelFromPatient_(volume.voxelFromPatient()) {}

void PacketRays::directions(int x0, int y0, RayPacket& p) {
  const CameraPicture& c = camera_;
  p.parallel = c.projection == Projection::Orthographic;
  for (int n = 0; n < kPacketRays; ++n) {
    const double sx = (x0 + n % kPacketEdge_px + 0.5 - 0.5 * c.width_px) * c.pixelStep;
    const double sy = (0.5 * c.height_px - (y0 + n / kPacketEdge_px + 0.5)) * c.pixelStep;
    double across[3], forward[3];
    for (int a = 0; a < 3; ++a) across[a] = c.right.v[a] * sx + c.up.v[a] * sy, forward[a] = c.forward.v[a];
    if (p.parallel) {
      for (int a = 0; a < 3; ++a) eye_[a][n] = c.eye.p[a] + across[a], p.towards[a][n] = forward[a];
      rayPerDepth_[n] = 1;
      continue;
    }
    double size = 0;
    for (int a = 0; a < 3; ++a) forward[a] += across[a], size += forward[a] * forward[a];
    size = std::sqrt(size);
    for (int a = 0; a < 3; ++a) eye_[a][n] = c.eye.p[a], p.towards[a][n] = forward[a] / size;
    rayPerDepth_[n] = size;
  }
}

void PacketRays::spans(RayPacket& p) const {
  for (int n = 0; n < kPacketRays; ++n)
    p.from_mm[n] = std::max(0.0, camera_.near_mm * rayPerDepth_[n]),
    p.to_mm[n] = std::numeric_limits<double>::infinity();
  for (const HalfSpace& h : region_) {
    const double nx = h.normal.v.x, ny = h.normal.v.y, nz = h.normal.v.z;
    for (int n = 0; n < kPacketRays; ++n) {
      const double outside = nx * eye_[0][n] + ny * eye_[1][n] + nz * eye_[2][n] - h.offset_mm;
      const double slope = nx * p.towards[0][n] + ny * p.towards[1][n] + nz * p.towards[2][n];
      const double at = -outside / slope;
      const bool never = slope == 0 && outside > 0;
      p.to_mm[n] = slope > 0 ? std::min(p.to_mm[n], at) : never ? -1 : p.to_mm[n];
      p.from_mm[n] = slope < 0 ? std::max(p.from_mm[n], at) : p.from_mm[n];
    }
  }
}

void PacketRays::set(int x0, int y0, RayPacket& p) {
  directions(x0, y0, p);
  spans(p);
  const glm::dmat3& m = voxelFromPatient_.linear;
  const glm::dvec3& t = voxelFromPatient_.translation;
  for (int a = 0; a < 3; ++a)
    for (int n = 0; n < kPacketRays; ++n) {
      p.origin[a][n] = m[0][a] * eye_[0][n] + m[1][a] * eye_[1][n] + m[2][a] * eye_[2][n] + t[a];
      p.direction[a][n] = m[0][a] * p.towards[0][n] + m[1][a] * p.towards[1][n] + m[2][a] * p.towards[2][n];
    }
}

}  // namespace vernier::native
