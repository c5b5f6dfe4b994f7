// SPDX-License-Identifier: GPL-3.0-or-later
// The border to VTK's reader, which lies in a library of its own (VtkSymbol.h). Plain numbers cross, so that
// no VTK header is seen outside of that library.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/base/Result.h"

namespace vernier::surface {

struct VtkPolyData {
  std::string error;                   // what VTK said, without file names; "" when it read the file
  std::vector<double> xyz;             // 3 per point
  std::vector<std::uint32_t> corners;  // of all polygons and strips, one after the other
  std::vector<std::uint64_t> polygonEnds, stripEnds;  // offsets into corners; the polygons come first
};

// XML PolyData, from memory, read in a process of its own (VtkLibrary.cpp says why). FormatUnknown where
// VTK's libraries are not installed. May throw std::bad_alloc.
Result<VtkPolyData> readVtpBytes(std::string_view bytes);

extern "C" using VtkReadFn = void(const char* bytes, std::size_t count, VtkPolyData* out);
inline constexpr const char* kVtkReadName = "vernier_vtk_read_vtp";

}  // namespace vernier::surface
