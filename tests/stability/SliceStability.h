// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of one slice layer for the extreme cases, drawn by each technique that can draw here.
#pragma once
#include <utility>

#include "../unit/volume/Grids.h"
#include "RenderForTest.h"

namespace vernier::test {

inline GridGeometry boxGrid(std::int64_t columns, std::int64_t rows, std::int64_t slices, glm::dvec3 spacing,
                            glm::dvec3 origin = glm::dvec3(0)) {
  GridGeometry g = unitGrid(columns, rows, slices);
  for (int n = 0; n < 3; ++n) g.patientFromVoxel.linear[n][n] = spacing[n];
  g.patientFromVoxel.translation = origin;
  return g;
}

template <class T>
std::shared_ptr<const Volume> noise(GridGeometry grid, double low, double high) {
  VolumeInfo info;
  info.grid = std::move(grid);
  const auto n = static_cast<std::size_t>(info.grid.columns * info.grid.rows * info.grid.slices);
  return volumeOf<T>(std::move(info), randomValues<T>(n, 11, low, high));
}

struct StabilityCase {
  Scene scene;
  View view;
  Sources sources;
  SliceLayer& layer() { return std::get<SliceLayer>(scene.layers[0]); }
};

inline StabilityCase sliceCase(std::shared_ptr<const Volume> volume, Plane plane, int width, int height,
                               double height_mm) {
  StabilityCase c;
  SliceLayer layer;
  layer.source = "v";
  layer.plane = plane;
  layer.window = VoiWindow{0, 2000, VoiFunction::LinearExact, ""};
  c.scene.layers.emplace_back(layer);
  c.scene.camera.height_mm = height_mm;
  c.view = View{width, height, true};
  c.sources.volumes["v"] = std::move(volume);
  return c;
}

// Draws with each technique in turn; `check` gets what it drew. Native must draw, GL may refuse.
template <class Check>
void forEachTechnique(const StabilityCase& c, Check&& check) {
  for (const std::string& technique : sliceTechniques()) {
    SCOPED_TRACE(technique);
    const auto r = renderWith(technique, c.scene, c.view, c.sources);
    if (!r && technique != "mpr.native" && r.error().code == ErrorCode::NoTechnique) continue;
    ASSERT_TRUE(r.ok()) << r.error().text();
    check(*r, technique);
  }
}

// The same again with cubic interpolation, for cases whose truth it shares: fields that it reproduces.
template <class Check>
void forEachTechniqueAndCubic(StabilityCase c, Check&& check) {
  forEachTechnique(c, check);
  SCOPED_TRACE("cubic");
  c.layer().interpolation = Interpolation::Cubic;
  forEachTechnique(c, check);
}

// What a technique may differ from double by, in modality units, where the voxels used span `local`.
inline double allowed(const Rendered& r, double local, double whole) {
  return (r.fixedFunction ? 3.0 / 512 : 1e-4) * local + 1e-6 * whole;
}

inline const Plane kAxial{{}, PatientVec(0, 0, -1), PatientVec(0, -1, 0)};
inline const Plane kCoronal{{}, PatientVec(0, -1, 0), PatientVec(0, 0, 1)};
inline const Plane kSagittal{{}, PatientVec(1, 0, 0), PatientVec(0, 0, 1)};

inline Plane through(Plane plane, PatientPoint p) {
  plane.point = p;
  return plane;
}

}  // namespace vernier::test
