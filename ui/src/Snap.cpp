// SPDX-License-Identifier: GPL-3.0-or-later
#include "Snap.h"

#include <algorithm>
#include <cmath>

namespace vernier::ui {
namespace {

using measure::Spot;

constexpr double kOnSlice = 1e-3;  // of a step, as the measure module

std::vector<Spot> cornersOf(const measure::Measurement& m) {
  measure::Measurement box = m;
  if (const auto* e = std::get_if<measure::EllipseRegion>(&m.shape))
    box.shape = measure::RectangleRegion{e->corners};
  else if (!std::holds_alternative<measure::RectangleRegion>(m.shape) &&
           !std::holds_alternative<measure::PolygonRegion>(m.shape) &&
           !std::holds_alternative<measure::FreehandRegion>(m.shape))
    return {};
  std::vector<Spot> corners = linesOf(box).at(0);
  if (!corners.empty()) corners.pop_back();  // closed
  return corners;
}

double sliceDepth(const GridGeometry& g, std::int64_t k) {
  return g.even() ? static_cast<double>(k) : g.sliceOrigin_vox[static_cast<std::size_t>(k)].z;
}
std::int64_t nearestSlice(const GridGeometry& g, double depth) {
  std::int64_t best = 0;
  for (std::int64_t k = 1; k < g.slices; ++k)
    if (std::abs(sliceDepth(g, k) - depth) < std::abs(sliceDepth(g, best) - depth)) best = k;
  return best;
}

// The plane of the slices through a point, seen as the patient's plane nearest to it is seen (Presets.h).
Snap turned(const GridGeometry& g, PatientPoint middle) {
  static constexpr struct {
    const char* view;
    glm::dvec3 normal, up;
  } kViews[] = {{"sagittal", {1, 0, 0}, {0, 0, 1}},
                {"coronal", {0, -1, 0}, {0, 0, 1}},
                {"axial", {0, 0, -1}, {0, -1, 0}}};
  const glm::dmat3& m = g.patientFromVoxel.linear;
  glm::dvec3 n = glm::normalize(glm::cross(m[0], m[1]));
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(n[k]) > std::abs(n[axis])) axis = k;
  const auto& like = kViews[axis];
  if (glm::dot(n, like.normal) < 0) n = -n;
  Snap s;
  const bool straight = glm::length(glm::cross(n, like.normal)) < 1e-6;
  s.view = straight ? like.view : "oblique";
  s.plane = Plane{middle, PatientVec(n), PatientVec(like.up)};
  s.middle = middle;
  return s;
}

// Right and up of a plane, unit.
std::pair<glm::dvec3, glm::dvec3> sidesOf(PatientVec normal, PatientVec up) {
  const glm::dvec3 n = glm::normalize(normal.v);
  const glm::dvec3 u = glm::normalize(up.v - glm::dot(up.v, n) * n);
  return {glm::cross(u, n), u};
}

}  // namespace

std::optional<Snap> snapToAcquired(const measure::Measurement& m, const Plane& shown, const GridGeometry& g) {
  if (m.on.space != measure::Space::Patient || m.on.shown != measure::Shown::Slice || !m.on.axes ||
      g.slices < 1)
    return std::nullopt;
  const std::vector<Spot> corners = cornersOf(m);
  if (corners.empty()) return std::nullopt;
  const glm::dmat3 inverse = glm::inverse(g.patientFromVoxel.linear);
  const auto depth = [&](const glm::dvec3& p) { return (inverse * (p - g.patientFromVoxel.translation)).z; };
  double low = depth(corners[0]), high = low;
  glm::dvec3 middle(0);
  for (const Spot& p : corners) {
    low = std::min(low, depth(p)), high = std::max(high, depth(p));
    middle += p / static_cast<double>(corners.size());
  }
  const double at = sliceDepth(g, nearestSlice(g, depth(middle)));
  if (std::max(std::abs(low - at), std::abs(high - at)) <= kOnSlice) return std::nullopt;
  Snap s;
  s.moved = m;
  if (high - low <= kOnSlice) {
    const glm::dvec3 n = glm::normalize(m.on.axes->normal.v);
    const double perMm = (inverse * n).z;
    const std::vector<Spot> handles = measure::handlesOf(m.shape);
    for (std::size_t k = 0; k < handles.size(); ++k)
      measure::setHandle(s.moved.shape, k, handles[k] + (at - depth(handles[k])) / perMm * n);
    s.middle = PatientPoint(middle + (at - depth(middle)) / perMm * n);
    s.plane = through(shown, s.middle);
    return s;
  }
  const glm::dvec3 across =
      glm::normalize(glm::cross(g.patientFromVoxel.linear[0], g.patientFromVoxel.linear[1]));
  Snap to = turned(g, PatientPoint(middle + (at - depth(middle)) / (inverse * across).z * across));
  to.moved = std::move(s.moved);
  to.moved.on.axes = measure::Placement::Axes{to.plane.normal, to.plane.up};
  const auto [right, up] = sidesOf(m.on.axes->normal, m.on.axes->up);
  const auto [toRight, toUp] = sidesOf(to.plane.normal, to.plane.up);
  const std::vector<Spot> handles = measure::handlesOf(m.shape);
  for (std::size_t k = 0; k < handles.size(); ++k) {
    const glm::dvec3 d = handles[k] - middle;
    measure::setHandle(to.moved.shape, k,
                       to.middle.p + glm::dot(d, right) * toRight + glm::dot(d, up) * toUp);
  }
  return to;
}

}  // namespace vernier::ui
