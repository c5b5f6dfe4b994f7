// SPDX-License-Identifier: GPL-3.0-or-later
// The border to VTK's marching cubes, in the library vernier_vtk.so (VtkSymbol.h). Plain numbers cross.
#pragma once
#include <cstdint>
#include <vector>

#include "vernier/base/Result.h"

namespace vernier::iso {

// A block of a field: nx x ny x nz values, x fastest. Its first layer has the number firstLayer.
struct VtkBlock {
  const float* values = nullptr;
  int nx = 0, ny = 0, nz = 0, firstLayer = 0;
};
struct VtkIsoSurface {
  std::vector<float> xyz;              // 3 per vertex: columns, rows and layers of the field
  std::vector<std::uint32_t> corners;  // 3 per triangle, counter-clockwise seen from where values are lower
};

extern "C" using VtkIsoFn = bool(const VtkBlock& block, double level, VtkIsoSurface* out);
inline constexpr const char* kVtkIsoName = "vernier_vtk_iso_surface";

}  // namespace vernier::iso
