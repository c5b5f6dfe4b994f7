// SPDX-License-Identifier: GPL-3.0-or-later
// Random scenes that look through small volumes, and their rays for brute force, with the planner's camera
// and region: nothing here is the reference's own. Cameras outside and inside, cuts, and two tools.
#pragma once
#include <cmath>

#include "BruteField.h"
#include "VolumeScenes.h"
#include "vernier/plan/Volumetric.h"

namespace vernier::test {

struct BruteTool {
  Real t = 1e30L, alpha = 1, shade = 1;
};

struct BruteCase {
  VolumeScene s;
  double pixelX = 0, pixelY = 0;
};

struct BruteRay {
  const Volume& volume;
  PatientRay ray;
  double perDepth = 1, from = 0, to = -1;
  bool endsAtTool = false;
  DepthRamp ramp;
  BruteTool translucent, opaque;

  glm::vec<3, Real> voxelAt(Real t) const {
    const glm::vec<3, Real> p = glm::vec<3, Real>(ray.origin.p) + t * glm::vec<3, Real>(ray.direction.v);
    const glm::dmat3& m = volume.voxelFromPatient().linear;
    const glm::dvec3& o = volume.voxelFromPatient().translation;
    const auto row = [&](int r) { return m[0][r] * p.x + m[1][r] * p.y + m[2][r] * p.z + o[r]; };
    return {row(0), row(1), row(2)};
  }
  Real valueAt(glm::vec<3, Real> p) const { return bruteValue(volume, p.x, p.y, p.z); }
};

inline BruteCase randomCase(std::uint64_t n, const Layer& layer) {
  const auto draw = [&](std::uint64_t k) { return randomUnit(4000 + n, k); };
  BruteCase c;
  c.s.sources.volumes["v"] = randomVolume(n % 5);
  c.s.scene.layers.push_back(layer);
  c.s.view = {40, 30};
  Camera& camera = c.s.scene.camera;
  camera.azimuth_deg = 360 * draw(0), camera.elevation_deg = 160 * draw(1) - 80,
  camera.roll_deg = 360 * draw(2);
  camera.projection = draw(3) < 0.5 ? Projection::Perspective : Projection::Orthographic;
  camera.zoom = 1 + draw(4), camera.pan_mm = {draw(5) - 0.5, draw(6) - 0.5};
  if (draw(7) < 0.3) camera.distance_mm = 0.3, camera.fov_deg = 70;  // inside
  if (draw(8) < 0.3) camera.near_mm = 1.5 * draw(9);
  if (draw(10) < 0.4)
    c.s.scene.crop = CropBox{VoxelPoint(draw(11), 0.7 * draw(12), draw(13)), VoxelPoint(2.5, 1.8, 2.9)};
  const GridGeometry& g = c.s.sources.volumes["v"]->grid();
  if (draw(14) < 0.4) {
    const glm::dvec3 normal(draw(15) - 0.5, draw(16) - 0.5, draw(17) - 0.5);
    c.s.scene.clip.push_back(
        {PatientVec(normal), glm::dot(normal, g.centre().p) + 0.3 * glm::length(normal)});
  }
  const auto addSheet = [&](double offset_mm, double alpha) {
    SurfaceLayer& sheet = c.s.sheet(0, alpha, {1, 0.5, 0});
    sheet.pose.translation = g.centre().p + glm::dvec3(0, offset_mm, 0);
  };
  if (draw(18) < 0.5) addSheet(draw(19) - 0.5, 0.4);
  if (draw(20) < 0.4) addSheet(1.4 * (draw(21) - 0.5), 1);
  c.pixelX = static_cast<double>(static_cast<int>(10 + 20 * draw(22))) + 0.5;
  c.pixelY = static_cast<double>(static_cast<int>(8 + 14 * draw(23))) + 0.5;
  return c;
}

inline BruteRay bruteOf(const BruteCase& c) {
  const Scene& scene = c.s.scene;
  const Volume& volume = *c.s.sources.volumes.at("v");
  const CameraPicture camera = *cameraPicture(scene.camera, c.s.view, cameraBox(volume.grid()));
  BruteRay b{
      .volume = volume, .ray = camera.ray(c.pixelX, c.pixelY), .ramp = {}, .translucent = {}, .opaque = {}};
  b.perDepth = camera.rayPerDepth(c.pixelX, c.pixelY);
  b.ramp = depthRamp(camera, volume.grid());
  const RaySpan span = spanOf(b.ray, *keptRegion(scene, volume.grid()), camera.near_mm * b.perDepth);
  b.from = span.entry_mm, b.to = span.exit_mm;
  for (std::size_t n = 1; n < scene.layers.size(); ++n) {
    const auto& sheet = std::get<SurfaceLayer>(scene.layers[n]);
    const Real t = (sheet.pose.translation.y - b.ray.origin.p.y) / b.ray.direction.v.y;
    if (t < 0 || t < camera.near_mm * b.perDepth) continue;
    const glm::dvec3 off = b.ray.at(static_cast<double>(t)).p - sheet.pose.translation;
    if (std::max(std::abs(off.x), std::abs(off.z)) > 50) continue;  // past the sheet's edge
    const BruteTool tool{t, sheet.opacity, 0.2L + 0.8L * std::abs(b.ray.direction.v.y)};
    (sheet.opacity < 1 ? b.translucent : b.opaque) = tool;
  }
  if (b.opaque.t < b.to) b.to = static_cast<double>(b.opaque.t), b.endsAtTool = true;
  return b;
}

}  // namespace vernier::test
