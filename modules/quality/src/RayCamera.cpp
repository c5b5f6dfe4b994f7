// SPDX-License-Identifier: GPL-3.0-or-later
#include "RayCamera.h"

#include <cmath>
#include <numbers>

namespace vernier::quality {
namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace

Result<RayCamera> RayCamera::make(const Camera& c, const View& view, glm::dvec3 centre, double diagonal_mm) {
  const double a = radians(c.azimuth_deg), e = radians(c.elevation_deg), r = radians(c.roll_deg),
               half = radians(c.fov_deg / 2);
  const glm::dvec3 towards(std::sin(a) * std::cos(e), -std::cos(a) * std::cos(e), std::sin(e));
  const glm::dvec3 right0(std::cos(a), std::sin(a), 0), up0 = glm::cross(towards, right0);

  RayCamera camera;
  camera.perspective = c.projection == Projection::Perspective;
  camera.forward = -towards;
  camera.right = right0 * std::cos(r) - up0 * std::sin(r);
  camera.down = -(up0 * std::cos(r) + right0 * std::sin(r));
  camera.near_mm = c.near_mm;
  camera.middle = {view.width_px / 2.0, view.height_px / 2.0};
  double distance = diagonal_mm;
  if (camera.perspective)
    distance = c.height_mm ? *c.height_mm / 2 / std::tan(half) : diagonal_mm / 2 / std::sin(half);
  distance = c.distance_mm.value_or(distance);
  camera.eye = (c.target ? c.target->p : centre) + towards * distance + camera.right * c.pan_mm.x -
               camera.down * c.pan_mm.y;
  const double height = camera.perspective ? 2 * std::tan(half) : c.height_mm.value_or(diagonal_mm);
  camera.step = height / c.zoom / view.height_px;
  if (!(camera.step > 0) || !std::isfinite(camera.step) ||
      !std::isfinite(camera.eye.x + camera.eye.y + camera.eye.z))
    return makeError(ErrorCode::SceneInvalid, "The camera's scale or place is not a finite number.",
                     "/camera");
  return camera;
}

PixelRay RayCamera::ray(glm::dvec2 pixel) const {
  const glm::dvec2 at = (pixel - middle) * step;
  const glm::dvec3 across = at.x * right + at.y * down;
  if (!perspective) return {eye + across, forward, 1};
  const double length = std::sqrt(1 + glm::dot(at, at));
  return {eye, (forward + across) / length, 1 / length};
}

bool RayCamera::pixelOf(glm::dvec3 patient, glm::dvec2& pixel) const {
  const glm::dvec3 q = patient - eye;
  const double z = glm::dot(q, forward);
  if (!(z > 0)) return false;
  pixel = glm::dvec2(glm::dot(q, right), glm::dot(q, down)) / ((perspective ? z : 1) * step) + middle;
  return true;
}

}  // namespace vernier::quality
