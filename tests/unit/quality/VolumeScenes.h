// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that look through small volumes, with sheets as tools.
#pragma once
#include <optional>

#include "Scenes.h"

namespace vernier::test {

inline VoiWindow unitWindow() { return {0.5, 1, VoiFunction::LinearExact, ""}; }

struct VolumeScene {
  Scene scene;
  View view{1, 1};
  Sources sources;
  ProjectionLayer& projection() { return std::get<ProjectionLayer>(scene.layers[0]); }
  ShellsLayer& shells() { return std::get<ShellsLayer>(scene.layers[0]); }
  VolumeLayer& volume() { return std::get<VolumeLayer>(scene.layers[0]); }
  IsosurfaceLayer& iso() { return std::get<IsosurfaceLayer>(scene.layers[0]); }

  // A square across the y axis.
  SurfaceLayer& sheet(double y_mm, double opacity, Rgb colour, double half_mm = 50) {
    MeshBuilder b;
    const std::uint32_t v[4] = {b.vertex({-half_mm, y_mm, -half_mm}), b.vertex({half_mm, y_mm, -half_mm}),
                                b.vertex({half_mm, y_mm, half_mm}), b.vertex({-half_mm, y_mm, half_mm})};
    b.triangle(v[0], v[1], v[2]);
    b.triangle(v[0], v[2], v[3]);
    SurfaceLayer layer;
    layer.source = "sheet" + std::to_string(scene.layers.size());
    layer.opacity = opacity, layer.colour = colour;
    sources.meshes[layer.source] = *b.finish();
    scene.layers.emplace_back(layer);
    return std::get<SurfaceLayer>(scene.layers.back());
  }
  // Keeps y >= from_mm.
  void clipBefore(double from_mm) { scene.clip.push_back({PatientVec(0, -1, 0), -from_mm}); }
  void crop(double from_vox, double to_vox) {
    scene.crop = CropBox{VoxelPoint(-1, from_vox, -1), VoxelPoint(9, to_vox, 9)};
  }
};

template <class LayerKind>
VolumeScene volumeScene(std::shared_ptr<const Volume> volume, LayerKind layer = {}) {
  VolumeScene s;
  layer.source = "v";
  if constexpr (requires { layer.window; })
    if (!layer.window) layer.window = unitWindow();
  s.scene.layers.emplace_back(layer);
  s.sources.volumes["v"] = std::move(volume);
  return s;
}

// Four voxels along each ray: value along y, the same along x and z. Voxel j lies at y = j mm. The eye plane
// lies 10 mm before the first one, and the only pixel looks along y through the middle.
inline constexpr double kFour[4] = {0.2, 0.8, 0.4, 0.6};
template <class LayerKind>
VolumeScene fourVoxels(LayerKind layer = {}, const double (&values)[4] = kFour) {
  VolumeScene s =
      volumeScene(floatVolume(gridOf(2, 4, 2), [&](auto, auto j, auto) { return values[j]; }), layer);
  s.scene.camera.distance_mm = 11.5;
  s.scene.camera.height_mm = 1;
  return s;
}

inline quality::ReferencePixel pixelOf(const VolumeScene& s, std::size_t pixel = 0) {
  const auto p = quality::referencePixels(s.scene, s.view, s.sources, std::span(&pixel, 1));
  EXPECT_TRUE(p.ok()) << (p.ok() ? "" : p.error().text());
  return p.ok() ? (*p)[0] : quality::ReferencePixel{};
}
inline void expectPixel(const VolumeScene& s, glm::dvec3 expected, double within = 1e-6) {
  const glm::dvec4 got = pixelOf(s).rgba;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], expected[c], within) << "channel " << c;
}
inline Error refusalOf(const VolumeScene& s, const quality::ReferenceOptions& options = {}) {
  const std::size_t pixel = 0;
  const auto p = quality::referencePixels(s.scene, s.view, s.sources, std::span(&pixel, 1), options);
  EXPECT_FALSE(p.ok());
  return p.ok() ? Error{} : p.error();
}

}  // namespace vernier::test
