// SPDX-License-Identifier: GPL-3.0-or-later
// Random volumes of every sample type, and the grids that they lie on, for the tests of slices.
#pragma once
#include "SliceCases.h"

namespace vernier::test {

template <class T>
struct Values {
  static constexpr double low = std::is_signed_v<T> ? -3000 : 0, high = 4000;
};
template <>
struct Values<std::uint8_t> {
  static constexpr double low = 0, high = 255.99;
};
template <>
struct Values<std::int8_t> {
  static constexpr double low = -128, high = 127.99;
};
template <>
struct Values<std::uint16_t> {
  static constexpr double low = 0, high = 65535.99;
};
template <>
struct Values<std::uint32_t> {
  static constexpr double low = 0, high = 4294967295.0;
};

template <class T>
std::shared_ptr<const Volume> randomVolume(const GridGeometry& grid, std::uint64_t seed) {
  VolumeInfo info;
  info.grid = grid;
  info.rescale = {{0.75, -1024.5}};
  const auto n = static_cast<std::size_t>(grid.columns * grid.rows * grid.slices);
  return volumeOf<T>(info, randomValues<T>(n, seed, Values<T>::low, Values<T>::high));
}

inline std::vector<NamedGrid> evenGrids() {
  std::vector<NamedGrid> grids;
  for (NamedGrid& g : everyGrid())
    if (g.grid.even()) grids.push_back(g);
  GridGeometry thick = grids[1].grid;  // oblique
  thick.patientFromVoxel.linear[2] *= 50 * 0.7 / 2.5;
  grids.push_back({"1:50", thick});
  for (int axis = 0; axis < 3; ++axis) {
    GridGeometry flat = grids[1].grid;
    (axis == 0 ? flat.columns : axis == 1 ? flat.rows : flat.slices) = 1;
    grids.push_back({"one along axis " + std::to_string(axis), flat});
  }
  return grids;
}

}  // namespace vernier::test
