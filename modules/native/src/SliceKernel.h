// SPDX-License-Identifier: GPL-3.0-or-later
// What the slice kernels share: the job in voxel coordinates, the display step, a tile.
#pragma once
#include <cstdint>

#include "vernier/native/Slice.h"
#include "vernier/volume/Voi.h"

namespace vernier::native {

// Sample k of pixel (x, y) lies at origin + x * right + y * down + k * step, in voxels.
struct VoxelLattice {
  glm::dvec3 origin{0}, right{0}, down{0}, step{0};
  int samples = 1;
  glm::dvec3 at(int x, int y, int k) const {
    return origin + static_cast<double>(x) * right + static_cast<double>(y) * down +
           static_cast<double>(k) * step;
  }
};
VoxelLattice latticeOf(const SliceJob&);

// Modality value -> grey 0..1. `ramp`: it is clamp(scale * value + offset), inversion included.
struct Display {
  VoiWindow window;
  bool invert = false;
  bool ramp = false;
  double scale = 0, offset = 0;
  float background[3] = {0, 0, 0};
  double grey(double modality) const {
    const double g = applyVoi(window, modality);
    return invert ? 1.0 - g : g;
  }
};
Display displayOf(const SliceJob&);

struct Target {
  int width = 0;
  float* colour = nullptr;
  float* depth = nullptr;
  float* values = nullptr;  // may be null
};

struct Tile {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

// Puts one pixel; value NaN = no data.
void putPixel(const Display&, const Target&, int x, int y, double modality);

// Kernels: draw a tile, return the number of samples that lay in the volume. They stop between rows.
using TileKernel = std::uint64_t (*)(const SliceJob&, const VoxelLattice&, const Display&, const Target&,
                                     const Tile&, const std::stop_token&);
TileKernel generalKernel(VoxelType);

}  // namespace vernier::native
