// SPDX-License-Identifier: GPL-3.0-or-later
// A volume rendering job made ready for the SIMD kernel. Lanes are the rays of a packet of 4 x 4 pixels that
// march through the lattice side by side: neighbouring rays read neighbouring voxels, skip the same bins
// (BrickMarks.h), and no lane waits for the one before it. Positions are double at the beginning of each
// block of 16 steps and float from there. Values are `w`, stored minus a whole `bias`.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "SliceFast.h"
#include "VolumeRay.h"

namespace vernier::native {

// Appearances drawn together: where the rays of a packet enter and leave each lens, mm; entry > exit: never.
struct PacketLenses {
  int count = 0;
  alignas(64) double entry_mm[kMostInsides][kPacketRays], exit_mm[kMostInsides][kPacketRays];
};

// The rays of a packet, and one part of each. Lane n is pixel (n % 4, n / 4).
struct RayPacket {
  alignas(64) double origin[3][kPacketRays];                    // voxels, at the lattice's origin
  alignas(64) double direction[3][kPacketRays];                 // voxels per mm
  alignas(64) double towards[3][kPacketRays];                   // unit, in the patient, away from the eye
  alignas(64) double from_mm[kPacketRays], to_mm[kPacketRays];  // empty: from > to
  bool parallel = false;                                        // all rays have the direction of the first
  const PacketLenses* lenses = nullptr;                         // null: no ray of it meets any
  VoxelRay ray(int n) const {
    return {
        {origin[0][n], origin[1][n], origin[2][n]}, {direction[0][n], direction[1][n], direction[2][n]}, 1};
  }
  glm::dvec3 forward(int n) const { return {towards[0][n], towards[1][n], towards[2][n]}; }
};

struct PacketMarks {
  RayMarks seen;
  const std::uint64_t* holes = nullptr;  // bins to be done in double; null: none
};

struct FastLamp {
  bool atEye = true;
  float towards[3] = {0, 0, 0}, colour[3] = {1, 1, 1};
};

// The tables of appearances drawn together, the outside's first, one behind the other in FastVolume's; of
// what shows nothing an empty one. By appearance.
struct FastLooks {
  std::vector<float> placeScale, placeOffset, lastPlace, seenFrom, seenTo;
  std::vector<std::int32_t> first, entries;
  std::vector<const GeneralBlend*> general;  // null: shows nothing
};

struct FastVolume {
  const VolumeRenderJob* job = nullptr;
  const GeneralBlend* general = nullptr;
  FastSlice read;                         // data, strides, bias
  float placeScale = 0, placeOffset = 0;  // of w in the table
  float lastPlace = 0;
  float seenFrom = 0, seenTo = 0;  // places between which alone an entry has any opacity
  int entries = 0;
  std::vector<float> opacity;  // Post: of a step; PreIntegrated: entries * entries
  std::array<std::vector<std::uint32_t>, 3>
      colour;                             // Post: 16 bits of value, 16 of the way to the next entry
  std::array<std::vector<float>, 3> lit;  // PreIntegrated: premultiplied colour
  FastLooks looks;                        // of jobs with insides
  bool shaded = false, ownColour = true;
  float ambient[3] = {}, diffuse[3] = {};  // the material's part times its colour, or the part alone
  float specular = 0, power = 1;
  int wholePower = -1;  // the power where it is whole and small
  std::vector<FastLamp> lamps;
  float patientGradient[3][3] = {};  // rows
};

// nullopt: only GeneralBlend can draw it.
std::optional<FastVolume> fastVolumeOf(const VolumeRenderJob&);

using FastBlend = void (*)(const FastVolume&, const RayPacket&, const PacketMarks&, RayLight*,
                           ProjectionWork&);
struct FastBlends {
  FastBlend plain = nullptr, lensed = nullptr;
};
FastBlends fastBlendsFor(const FastVolume&);

}  // namespace vernier::native
