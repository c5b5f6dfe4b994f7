// SPDX-License-Identifier: GPL-3.0-or-later
// The rays of packets (VolumeFast.h): CameraPicture::ray and spanOf for 16 pixels at a time.
#pragma once
#include <vector>

#include "VolumeFast.h"

namespace vernier::native {

class PacketRays {
 public:
  PacketRays(const CameraPicture&, const std::vector<HalfSpace>& region, const Volume&);
  // The packet whose first pixel is (x0, y0), from_mm and to_mm being all of the region. Not for two threads.
  void set(int x0, int y0, RayPacket&);

 private:
  void directions(int x0, int y0, RayPacket&);
  void spans(RayPacket&) const;
  const CameraPicture& camera_;
  const std::vector<HalfSpace>& region_;
  VoxelFromPatient voxelFromPatient_;
  alignas(64) double eye_[3][kPacketRays] = {}, rayPerDepth_[kPacketRays] = {};
};

}  // namespace vernier::native
