// SPDX-License-Identifier: GPL-3.0-or-later
// Small volumes for the tests of this room: filled by a function, on grids of every kind that GridGeometry
// knows.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vernier/base/Random.h"
#include "vernier/volume/Volume.h"

namespace vernier::test {

template <class T>
constexpr VoxelType typeFor() {
  if constexpr (std::is_same_v<T, std::uint8_t>) return VoxelType::U8;
  if constexpr (std::is_same_v<T, std::int8_t>) return VoxelType::I8;
  if constexpr (std::is_same_v<T, std::uint16_t>) return VoxelType::U16;
  if constexpr (std::is_same_v<T, std::int16_t>) return VoxelType::I16;
  if constexpr (std::is_same_v<T, std::uint32_t>) return VoxelType::U32;
  if constexpr (std::is_same_v<T, std::int32_t>) return VoxelType::I32;
  return VoxelType::F32;
}

template <class T>
Buffer bufferOf(const std::vector<T>& values) {
  Result<Buffer> made = Buffer::make(values.size() * sizeof(T));
  EXPECT_TRUE(made.ok());
  Buffer b = std::move(made).value();
  if (!values.empty()) std::memcpy(b.data(), values.data(), values.size() * sizeof(T));
  return b;
}

inline GridGeometry unitGrid(std::int64_t columns, std::int64_t rows, std::int64_t slices) {
  GridGeometry g;
  g.columns = columns;
  g.rows = rows;
  g.slices = slices;
  return g;
}

template <class T>
std::shared_ptr<const Volume> volumeOf(VolumeInfo info, const std::vector<T>& values) {
  info.type = typeFor<T>();
  auto made = Volume::make(std::move(info), bufferOf(values));
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().text());
  return made.ok() ? *made : nullptr;
}

template <class T>
std::vector<T> randomValues(std::size_t n, std::uint64_t seed, double low, double high) {
  std::vector<T> v(n);
  for (std::size_t i = 0; i < n; ++i) v[i] = static_cast<T>(low + (high - low) * randomUnit(seed, i));
  return v;
}

struct NamedGrid {
  std::string name;
  GridGeometry grid;
};

// Oblique, sheared, left-handed, with uneven slices that also wander in the plane, with gaps.
inline std::vector<NamedGrid> everyGrid() {
  std::vector<NamedGrid> all;
  GridGeometry g = unitGrid(7, 6, 9);
  all.push_back({"unit", g});
  const glm::dvec3 x = glm::normalize(glm::dvec3(0.8, 0.5, 0.2));
  const glm::dvec3 z = glm::normalize(glm::cross(x, glm::dvec3(0.1, 0.9, -0.3)));
  const glm::dvec3 y = glm::cross(z, x);
  g.patientFromVoxel.linear = glm::dmat3(0.7 * x, 1.3 * y, 2.5 * z);
  g.patientFromVoxel.translation = {-120.5, 33.25, 1e3};
  all.push_back({"oblique", g});
  GridGeometry sheared = g;
  sheared.patientFromVoxel.linear[2] += 0.6 * y - 0.1 * x;
  all.push_back({"sheared", sheared});
  GridGeometry left = g;
  left.patientFromVoxel.linear[2] = -left.patientFromVoxel.linear[2];
  all.push_back({"left-handed", left});
  GridGeometry uneven = g;
  for (int s = 0; s < 9; ++s)
    uneven.sliceOrigin_vox.push_back({0.07 * std::sin(s), -0.05 * s, s + 0.3 * std::cos(2.0 * s)});
  all.push_back({"uneven", uneven});
  GridGeometry gap = g;
  for (int s = 0; s < 9; ++s)
    gap.sliceOrigin_vox.push_back({0, 0, s + (s > 3 ? 2.0 : 0.0) + (s > 6 ? 1.6 : 0.0)});
  gap.gapAfter = {3, 6};
  all.push_back({"gaps", gap});
  return all;
}

}  // namespace vernier::test
