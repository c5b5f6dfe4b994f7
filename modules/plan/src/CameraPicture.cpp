// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/CameraPicture.h"

#include <cmath>
#include <limits>

#include "vernier/base/Units.h"

namespace vernier {
namespace {

Error invalid(const char* key, const std::string& sentence) {
  return makeError(ErrorCode::SceneInvalid, sentence, std::string("/camera/") + key);
}

Result<void> check(const Camera& c, const View& view, const CameraBox& box) {
  if (view.width_px < 1 || view.height_px < 1)
    return makeError(ErrorCode::SceneInvalid,
                     "The picture has no pixels; give it a width and a height above 0.");
  if (!std::isfinite(c.azimuth_deg + c.elevation_deg + c.roll_deg))
    return invalid("azimuth_deg", "Azimuth, elevation and roll must be finite numbers.");
  if (!(c.zoom > 0) || !std::isfinite(c.zoom)) return invalid("zoom", "The zoom must be a number above 0.");
  if (!(c.fov_deg > 0 && c.fov_deg < 180))
    return invalid("fov_deg", "The field of view lies between 0 and 180 degrees.");
  if (!std::isfinite(c.pan_mm.x + c.pan_mm.y))
    return invalid("pan_mm", "The shift must be two finite numbers.");
  if (c.height_mm && !(*c.height_mm > 0 && std::isfinite(*c.height_mm)))
    return invalid("height_mm", "The picture's height must be a number above 0.");
  if (c.distance_mm && !std::isfinite(*c.distance_mm))
    return invalid("distance_mm", "The eye's distance must be a finite number.");
  if (!(c.near_mm >= 0) || !std::isfinite(c.near_mm))
    return invalid("near_mm", "The near distance is at least 0 mm.");
  const glm::dvec3 target = c.target ? c.target->p : box.centre.p;
  if (!std::isfinite(target.x + target.y + target.z))
    return invalid("target_mm", "The target must be finite.");
  if (!(box.diagonal_mm > 0) || !std::isfinite(box.diagonal_mm))
    return makeError(ErrorCode::SceneInvalid,
                     "What the camera looks at has no extent, so no picture can be fitted to it.");
  return {};
}

double eyeDistance(const Camera& c, double diagonal_mm) {
  if (c.distance_mm) return *c.distance_mm;
  if (c.projection == Projection::Orthographic) return diagonal_mm;
  const double half = 0.5 * Radians(Degrees(c.fov_deg)).rad;
  return c.height_mm ? 0.5 * *c.height_mm / std::tan(half) : 0.5 * diagonal_mm / std::sin(half);
}

void takeIn(glm::dvec3 p, glm::dvec3& low, glm::dvec3& high) {
  low = glm::min(low, p), high = glm::max(high, p);
}

}  // namespace

CameraBox cameraBox(const GridGeometry& grid) {
  // A sheared or uneven stack is not a box: its corners' mean and its longest diagonal stand for it.
  CameraBox box{grid.centre(), 0};
  for (int n = 0; n < 4; ++n)
    box.diagonal_mm = std::max(box.diagonal_mm, length(grid.corner(n) - grid.corner(7 - n)));
  return box;
}

Result<CameraBox> cameraBox(const Scene& scene, const Sources& sources) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const Layer& layer : scene.layers) {
    if (const std::string* named = volumeOf(layer)) {
      if (const auto v = sources.volumes.find(*named); v != sources.volumes.end())
        return cameraBox(v->second->grid());
    } else if (const auto* surface = std::get_if<SurfaceLayer>(&layer)) {
      const auto m = sources.meshes.find(surface->source);
      if (m == sources.meshes.end()) continue;
      const Mesh& mesh = *m->second;
      for (int n = 0; n < 8; ++n)
        takeIn((surface->pose * MeshPoint(n & 1 ? mesh.highest().p.x : mesh.lowest().p.x,
                                          n & 2 ? mesh.highest().p.y : mesh.lowest().p.y,
                                          n & 4 ? mesh.highest().p.z : mesh.lowest().p.z))
                   .p,
               low, high);
    }
  }
  if (!(low.x <= high.x))
    return makeError(ErrorCode::SceneInvalid, "The scene holds nothing that a 3-D camera could look at.",
                     "/layers");
  return CameraBox{PatientPoint(0.5 * (low + high)), glm::length(high - low)};
}

Result<CameraPicture> cameraPicture(const Camera& camera, const View& view, const CameraBox& box) {
  if (const Result<void> ok = check(camera, view, box); !ok) return ok.error();
  const double a = Radians(Degrees(camera.azimuth_deg)).rad, e = Radians(Degrees(camera.elevation_deg)).rad,
               r = Radians(Degrees(camera.roll_deg)).rad;
  const PatientVec right(std::cos(a), std::sin(a), 0);
  const PatientVec up(-std::sin(a) * std::sin(e), std::cos(a) * std::sin(e), std::cos(e));
  CameraPicture p;
  p.projection = camera.projection;
  p.width_px = view.width_px, p.height_px = view.height_px;
  p.forward = PatientVec(-std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), -std::sin(e));
  p.right = right * std::cos(r) - up * std::sin(r);
  p.up = up * std::cos(r) + right * std::sin(r);
  p.near_mm = camera.near_mm;
  p.targetDistance_mm = eyeDistance(camera, box.diagonal_mm);
  const PatientPoint target = camera.target ? *camera.target : box.centre;
  p.eye = target - p.forward * p.targetDistance_mm + p.right * camera.pan_mm.x + p.up * camera.pan_mm.y;
  const double height = p.projection == Projection::Orthographic
                            ? camera.height_mm.value_or(box.diagonal_mm)
                            : 2 * std::tan(0.5 * Radians(Degrees(camera.fov_deg)).rad);
  p.pixelStep = height / (camera.zoom * view.height_px);
  if (!(p.pixelStep > 0) || !std::isfinite(p.pixelStep))
    return invalid("zoom", "The picture's scale is not a finite number above 0.");
  return p;
}

glm::dmat4 CameraPicture::pixelFromPatient() const {
  const glm::dvec3 x = right.v / pixelStep, y = -up.v / pixelStep;
  const double cx = 0.5 * width_px, cy = 0.5 * height_px;
  const bool flat = projection == Projection::Orthographic;
  // Rows for x, y, z and w of a point relative to the eye; then the eye is taken off.
  const glm::dvec3 rows[4] = {flat ? x : x + cx * forward.v, flat ? y : y + cy * forward.v, forward.v,
                              flat ? glm::dvec3(0) : forward.v};
  const glm::dvec4 constant(flat ? cx : 0, flat ? cy : 0, 0, flat ? 1 : 0);
  glm::dmat4 m(0.0);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 3; ++column) m[column][row] = rows[row][column];
    m[3][row] = constant[row] - glm::dot(rows[row], eye.p);
  }
  return m;
}

EdgeLetters edgeLetters(const CameraPicture& picture) {
  return {lettersOf(-picture.right), lettersOf(picture.right), lettersOf(picture.up), lettersOf(-picture.up)};
}

}  // namespace vernier
