// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/LinkedViews.h"

#include "Vectors.h"

namespace vernier {
namespace {

constexpr double kLeastDistance_mm = 1e-6;

Error degenerate(const std::string& what, const std::string& next) {
  return makeError(ErrorCode::PlaneDegenerate, what + "; " + next + ".");
}

// Narrows [begin, end] to the t with low <= at + t * step <= high.
void clip(double at, double step, double low, double high, double& begin, double& end) {
  if (step == 0) {
    if (at < low || at > high) end = begin - 1;
    return;
  }
  const double a = (low - at) / step, b = (high - at) / step;
  begin = std::max(begin, std::min(a, b));
  end = std::min(end, std::max(a, b));
}

}  // namespace

Result<Plane> planeThrough(PatientPoint from, PatientPoint to, PatientVec up) {
  if (!finite(from.p) || !finite(to.p) || !finite(up.v))
    return degenerate("A point of the plane or its up vector is not finite", "give numbers");
  const glm::dvec3 between = to.p - from.p;
  const glm::dvec3 along = unit(between), upward = unit(up.v);
  if (!(glm::length(between) >= kLeastDistance_mm))
    return degenerate("The two points of the plane are the same", "give two that are apart");
  if (upward == glm::dvec3(0))
    return degenerate("The plane's up vector has no length", "give a direction across the line");
  const glm::dvec3 normal = glm::cross(along, upward);
  if (!(glm::length(normal) >= kLeastAngle_rad))
    return degenerate("The plane's up vector runs along the line between its points",
                      "give a direction across it");
  return Plane{PatientPoint(from.p + 0.5 * between), PatientVec(glm::normalize(normal)), up};
}

Plane patientPlane(PatientPlane which, PatientPoint point) {
  switch (which) {
    case PatientPlane::Coronal:
      return {point, PatientVec(0, -1, 0), PatientVec(0, 0, 1)};
    case PatientPlane::Sagittal:
      return {point, PatientVec(1, 0, 0), PatientVec(0, 0, 1)};
    case PatientPlane::Axial:
      break;
  }
  return {point, PatientVec(0, 0, -1), PatientVec(0, -1, 0)};
}

Plane movedThrough(const Plane& plane, PatientPoint point) {
  const glm::dvec3 n = unit(plane.normal.v);
  Plane moved = plane;
  if (finite(point.p)) moved.point = PatientPoint(plane.point.p + glm::dot(point.p - plane.point.p, n) * n);
  return moved;
}

LinkedPlanes linkedPlanes(const GridGeometry& grid, PatientPoint crosshair) {
  const auto through = [&](PatientPlane which) {
    return movedThrough(patientPlane(which, grid.centre()), crosshair);
  };
  return {through(PatientPlane::Axial), through(PatientPlane::Coronal), through(PatientPlane::Sagittal)};
}

std::optional<std::array<glm::dvec2, 2>> referenceLine(const SlicePicture& picture, const View& view,
                                                       const Plane& other) {
  const glm::dvec3 n = unit(other.normal.v);
  if (n == glm::dvec3(0) || !finite(other.point.p) || !(picture.mmPerPixel > 0)) return std::nullopt;
  // Pixels (x, y) on the other plane: dot(gradient, pixel) + offset = 0, in mm.
  const glm::dvec2 gradient(glm::dot(n, picture.right.v), glm::dot(n, picture.down.v));
  const double slope = glm::length(gradient);
  if (!(slope >= kLeastAngle_rad * picture.mmPerPixel)) return std::nullopt;
  const glm::dvec2 size(view.width_px, view.height_px), middle = 0.5 * size;
  const double offset = glm::dot(n, picture.origin.p - other.point.p) + glm::dot(gradient, middle);
  const glm::dvec2 across = gradient / slope;
  const glm::dvec2 nearest = middle - (offset / slope) * across;  // the line's point nearest to the middle
  glm::dvec2 along(-across.y, across.x);
  if (along.x < 0 || (along.x == 0 && along.y < 0)) along = -along;
  double begin = -glm::length(size), end = -begin;
  clip(nearest.x, along.x, 0, size.x, begin, end);
  clip(nearest.y, along.y, 0, size.y, begin, end);
  if (!(end > begin)) return std::nullopt;
  return std::array{nearest + begin * along, nearest + end * along};
}

}  // namespace vernier
