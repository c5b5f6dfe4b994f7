// SPDX-License-Identifier: GPL-3.0-or-later
// Small volumes and one-slice scenes for the tests of this room.
#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include "vernier/quality/Reference.h"

namespace vernier::test {

inline GridGeometry gridOf(std::int64_t columns, std::int64_t rows, std::int64_t slices,
                           glm::dvec3 spacing = glm::dvec3(1)) {
  GridGeometry g;
  g.columns = columns;
  g.rows = rows;
  g.slices = slices;
  for (int n = 0; n < 3; ++n) g.patientFromVoxel.linear[n][n] = spacing[n];
  return g;
}

using VoxelFunction = std::function<double(std::int64_t i, std::int64_t j, std::int64_t k)>;

// A float volume; `info` brings the grid and what else matters.
inline std::shared_ptr<const Volume> floatVolume(VolumeInfo info, const VoxelFunction& f) {
  const GridGeometry& g = info.grid;
  std::vector<float> v;
  for (std::int64_t k = 0; k < g.slices; ++k)
    for (std::int64_t j = 0; j < g.rows; ++j)
      for (std::int64_t i = 0; i < g.columns; ++i) v.push_back(static_cast<float>(f(i, j, k)));
  auto buffer = Buffer::make(v.size() * sizeof(float));
  std::memcpy(buffer->data(), v.data(), v.size() * sizeof(float));
  info.type = VoxelType::F32;
  auto made = Volume::make(std::move(info), std::move(*buffer));
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().text());
  return *made;
}
inline std::shared_ptr<const Volume> floatVolume(GridGeometry grid, const VoxelFunction& f) {
  VolumeInfo info;
  info.grid = std::move(grid);
  return floatVolume(std::move(info), f);
}

// A scene of one slice of the volume "v".
struct SliceScene {
  Scene scene;
  View view;
  Sources sources;
  SliceLayer& layer() { return std::get<SliceLayer>(scene.layers[0]); }
};
inline SliceScene sliceScene(std::shared_ptr<const Volume> volume, Plane plane, int size_px,
                             double height_mm) {
  SliceScene s;
  SliceLayer layer;
  layer.source = "v";
  layer.plane = plane;
  layer.window = VoiWindow{0.5, 1, VoiFunction::LinearExact, ""};
  s.scene.layers.emplace_back(layer);
  s.scene.camera.height_mm = height_mm;
  s.view.width_px = s.view.height_px = size_px;
  s.sources.volumes["v"] = std::move(volume);
  return s;
}

// The value at the point of the plane that the scene is centred on.
inline std::optional<quality::SliceValue> valueAtPoint(SliceScene s,
                                                       const quality::ReferenceOptions& options = {}) {
  const glm::dvec2 centre(0.5 * s.view.width_px, 0.5 * s.view.height_px);
  const auto v = quality::sliceValues(s.scene, 0, s.view, s.sources, std::span(&centre, 1), options);
  EXPECT_TRUE(v.ok()) << (v.ok() ? "" : v.error().text());
  return v.ok() ? (*v)[0] : std::nullopt;
}
inline std::optional<quality::SliceValue> valueAt(std::shared_ptr<const Volume> volume, PatientPoint p,
                                                  Interpolation interpolation = Interpolation::Linear) {
  SliceScene s = sliceScene(std::move(volume), Plane{p, PatientVec(0, 0, 1), PatientVec(0, 1, 0)}, 1, 1);
  s.layer().interpolation = interpolation;
  return valueAtPoint(s);
}
// The slab of the line from a to b.
inline std::optional<quality::SliceValue> valueAlong(std::shared_ptr<const Volume> volume, glm::dvec3 a,
                                                     glm::dvec3 b, SlabMode mode,
                                                     Interpolation interpolation = Interpolation::Linear,
                                                     const quality::ReferenceOptions& options = {}) {
  const glm::dvec3 d = b - a;
  const glm::dvec3 up = std::abs(d.x) < std::abs(d.y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  SliceScene s =
      sliceScene(std::move(volume), Plane{PatientPoint(0.5 * (a + b)), PatientVec(d), PatientVec(up)}, 1, 1);
  s.layer().slab = Slab{glm::length(d), mode};
  s.layer().interpolation = interpolation;
  return valueAtPoint(s, options);
}

}  // namespace vernier::test
