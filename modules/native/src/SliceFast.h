// SPDX-License-Identifier: GPL-3.0-or-later
// A slice job made ready for the SIMD kernel: even grids, one rescale; U8, U16, I16 and F32.
//
// Positions are fixed-point: 40 fractional bits in 64 for the first pixel of each block of 16 (the double
// lattice, to 2^-41 of a voxel per term), rounded to 24 bits; within the block 32-bit offsets from there with
// 24 fractional bits. The kernel interpolates `w`, the stored value minus a whole `bias` near the window's
// centre, so that float keeps its digits where the window looks: modality = slope * (w + bias) + intercept.
#pragma once
#include <array>
#include <optional>

#include "SliceKernel.h"

namespace vernier::native {

inline constexpr int kBlock_px = 16;
inline constexpr int kFineBits = 40, kLaneBits = 24;

struct FastSlice {
  std::array<std::int64_t, 3> origin{}, right{}, down{}, step{};  // 2^-40 voxel
  alignas(64) std::int32_t lane[3][kBlock_px];                    // 2^-24 voxel, from the block's first pixel
  // Where every fourth pixel (on odd rows: shifted by two) lies some rows further down, to be fetched ahead;
  // 2^-24 voxel, from the block's first pixel.
  alignas(16) std::int32_t ahead[2][3][kBlock_px / 4];
  bool fetchAhead = false;
  std::array<std::int32_t, 3> laneMin{}, laneMax{};
  std::array<std::int64_t, 3> last{};       // greatest voxel index
  std::array<std::int64_t, 3> stride{};     // bytes from voxel to voxel
  std::array<std::int64_t, 3> neighbour{};  // the same, 0 on an axis that has one voxel only
  const std::uint8_t* data = nullptr;
  std::int64_t inset = 0;  // 2^-40 voxel: this far inside the outer voxel centres, reads need no tests
  int samples = 1;
  SlabMode mode = SlabMode::Max;  // of stored values: swapped for a negative slope
  std::int32_t bias = 0;
  double slope = 1, intercept = 0;
  float scale = 0, offset = 0;  // grey = clamp(scale * w + offset) when Display::ramp
  bool hasRange = false;        // no-data in [noFirst, noLast], as integers or floats
  std::int32_t noFirst = 0, noLast = -1;
  float noFirstFloat = 0, noLastFloat = -1;
};

// nullopt: only the general kernel can draw it.
std::optional<FastSlice> fastSliceOf(const SliceJob&, const VoxelLattice&, const Display&);

// Cubic interpolation is a source of its own; drawFast() hands over to it.
std::uint64_t drawFastCubic(const FastSlice&, const SliceJob&, const VoxelLattice&, const Display&,
                            const Target&, const Tile&, const std::stop_token&);

// Draws a tile whose x0 is a multiple of kBlock_px; returns the number of samples that lay in the volume.
std::uint64_t drawFast(const FastSlice&, const SliceJob&, const VoxelLattice&, const Display&, const Target&,
                       const Tile&, const std::stop_token&);

}  // namespace vernier::native
