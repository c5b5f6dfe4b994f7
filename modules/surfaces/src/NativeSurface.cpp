// SPDX-License-Identifier: GPL-3.0-or-later
// surface.native: all surface layers of a scene in one pass, so that they hide each other and shine through
// each other as they should.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "SurfaceTechniques.h"
#include "vernier/native/Surfaces.h"
#include "vernier/plan/Volumetric.h"

namespace vernier::surfaces {
namespace {

// Built-in costs of one thread, measured; per triangle that is set up and per pixel of the picture.
constexpr double kTriangle_ns = 120.0, kPixel_ns = 25.0;

struct SurfaceParams final : PassParams {
  native::SurfaceJob job;
  View view;
  std::string dump() const override;
};

std::string number(double v) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::general, 6);
  return std::string(text, end.ptr);
}

std::string SurfaceParams::dump() const {
  std::string s = job.camera.projection == Projection::Perspective ? "perspective" : "orthographic";
  s += ", pixel " + number(job.camera.mmPerPixel()) + " mm";
  for (const PlacedSurface& p : job.surfaces) {
    const double volumeScale = glm::determinant(p.pose.linear);
    s += "; " + std::to_string(p.mesh->triangles().size()) + " triangles, opacity " + number(p.opacity);
    if (std::abs(std::abs(volumeScale) - 1) > 1e-6)
      s += ", scaled " + number(std::cbrt(std::abs(volumeScale)));
    if (volumeScale < 0) s += ", mirrored";
  }
  return s;
}

// Index of the scene's first surface layer: its pass draws them all.
std::size_t firstSurface(const Scene& scene) {
  const auto it = std::find_if(scene.layers.begin(), scene.layers.end(),
                               [](const Layer& l) { return std::holds_alternative<SurfaceLayer>(l); });
  return static_cast<std::size_t>(it - scene.layers.begin());
}

Result<std::shared_ptr<const SurfaceParams>> surfaceParams(const PlanContext& context) {
  auto p = std::make_shared<SurfaceParams>();
  Result<std::vector<PlacedSurface>> surfaces = placedSurfaces(context.scene, context.sources);
  if (!surfaces) return surfaces.error();
  p->job.surfaces = std::move(*surfaces);
  const Result<CameraBox> box = cameraBox(context.scene, context.sources);
  if (!box) return box.error();
  Result<CameraPicture> camera = cameraPicture(context.scene.camera, context.view, *box);
  if (!camera) return camera.error();
  p->job.camera = *camera;
  p->job.background = {context.scene.background.r, context.scene.background.g, context.scene.background.b};
  p->view = context.view;
  return std::shared_ptr<const SurfaceParams>(std::move(p));
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  if (!std::holds_alternative<SurfaceLayer>(layer))
    return makeError(ErrorCode::SceneInvalid, "The layer is no surface.");
  if (index != firstSurface(context.scene)) return std::vector<Pass>{};
  const Result<std::shared_ptr<const SurfaceParams>> params = surfaceParams(context);
  if (!params) return params.error();
  std::uint64_t triangles = 0, vertices = 0;
  for (const PlacedSurface& s : (*params)->job.surfaces) {
    if (!(s.opacity > 0)) continue;
    triangles += s.mesh->triangles().size();
    vertices += s.mesh->vertices().size();
  }
  const double pixels = static_cast<double>(context.view.width_px) * context.view.height_px;
  Pass pass;
  pass.name = (*params)->job.surfaces.size() == 1
                  ? "surface " + std::to_string(index)
                  : "surfaces (" + std::to_string((*params)->job.surfaces.size()) + ")";
  pass.inputs = {"mesh"};
  pass.outputs = {"colour", "depth"};
  pass.resources = {{"vertices in pixels", 32 * vertices}, {"triangles by tile", 4 * triangles}};
  pass.predicted_ms = (static_cast<double>(triangles) * kTriangle_ns + pixels * kPixel_ns) * 1e-6 /
                      std::max(1, context.capabilities.threads);
  pass.predictedError = 1e-4;  // double throughout; the float frame rounds to 2^-24
  pass.params = *params;
  return std::vector<Pass>{std::move(pass)};
}

Result<void> execute(const Pass& pass, Images& images, std::stop_token stop) {
  const auto* p = dynamic_cast<const SurfaceParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no surface parameters.", "surface.native");
  return native::drawSurfaces(p->job, images, stop);
}

}  // namespace

Technique nativeSurfaceTechnique() {
  Technique t;
  t.name = "surface.native";
  t.kinds = {"surface"};
  t.engine = Engine::Native;
  t.passesFor = passesFor;
  t.execute = execute;
  return t;
}

}  // namespace vernier::surfaces
