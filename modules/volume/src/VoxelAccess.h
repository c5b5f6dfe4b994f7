// SPDX-License-Identifier: GPL-3.0-or-later
// From a VoxelType at run time to a C++ type: withVoxels(type, data, fn) calls fn with a typed pointer.
#pragma once
#include <cstddef>
#include <cstdint>

#include "vernier/volume/Volume.h"

namespace vernier {

template <class Fn>
auto withVoxels(VoxelType type, const std::byte* data, Fn&& fn) {
  switch (type) {
    case VoxelType::U8:
      return fn(reinterpret_cast<const std::uint8_t*>(data));
    case VoxelType::I8:
      return fn(reinterpret_cast<const std::int8_t*>(data));
    case VoxelType::U16:
      return fn(reinterpret_cast<const std::uint16_t*>(data));
    case VoxelType::I16:
      return fn(reinterpret_cast<const std::int16_t*>(data));
    case VoxelType::U32:
      return fn(reinterpret_cast<const std::uint32_t*>(data));
    case VoxelType::I32:
      return fn(reinterpret_cast<const std::int32_t*>(data));
    case VoxelType::F32:
      break;
  }
  return fn(reinterpret_cast<const float*>(data));
}

inline double storedAt(VoxelType type, const std::byte* data, std::size_t index) {
  return withVoxels(type, data, [index](const auto* v) { return static_cast<double>(v[index]); });
}

inline bool inRange(const std::optional<NoDataRange>& range, double stored) {
  return stored != stored || (range && stored >= range->first && stored <= range->last);
}

}  // namespace vernier
