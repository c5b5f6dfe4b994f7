// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Volumetric.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/volume/Voi.h"

namespace vernier {
namespace {

Error invalid(const std::string& where, const std::string& sentence) {
  return makeError(ErrorCode::SceneInvalid, sentence, where);
}

// The half-space voxel[axis] <= bound (or >= bound) in the patient.
HalfSpace acrossAxis(const GridGeometry& grid, int axis, double bound_vox, bool upper) {
  // Rows of the inverse map are the gradients of the voxel coordinates.
  const glm::dmat3 inverse = glm::inverse(grid.patientFromVoxel.linear);
  glm::dvec3 gradient(inverse[0][axis], inverse[1][axis], inverse[2][axis]);
  if (!upper) gradient = -gradient;
  const glm::dvec3 n = glm::normalize(gradient);
  glm::dvec3 on(0);
  on[axis] = bound_vox;
  const PatientPoint p = grid.patientFromVoxel * VoxelPoint(on);
  return {PatientVec(n), glm::dot(n, p.p)};
}

// Without the layers' own bends: what the slices of an uneven stack share is the even map's box, widened by
// how far slices wander.
void boxOf(const GridGeometry& grid, glm::dvec3& least, glm::dvec3& greatest) {
  least = {0, 0, grid.firstPosition_vox()};
  greatest = {static_cast<double>(grid.columns - 1), static_cast<double>(grid.rows - 1),
              grid.lastPosition_vox()};
  glm::dvec2 low(0), high(0);
  for (const glm::dvec3& o : grid.sliceOrigin_vox)
    low = glm::min(low, glm::dvec2(o)), high = glm::max(high, glm::dvec2(o));
  least += glm::dvec3(low, 0);
  greatest += glm::dvec3(high, 0);
}

void addBox(const GridGeometry& grid, glm::dvec3 least, glm::dvec3 greatest, std::vector<HalfSpace>& out) {
  for (int axis = 0; axis < 3; ++axis) {
    out.push_back(acrossAxis(grid, axis, least[axis], false));
    out.push_back(acrossAxis(grid, axis, greatest[axis], true));
  }
}

bool finite(glm::dvec3 v) { return std::isfinite(v.x + v.y + v.z); }

}  // namespace

Result<std::vector<HalfSpace>> keptRegion(const Scene& scene, const GridGeometry& grid) {
  if (grid.columns < 2 || grid.rows < 2 || grid.slices < 2)
    return makeError(
        ErrorCode::GeometryRefused,
        "The volume is a single slice, row or column, which has no inside to look through; show it "
        "as a slice.");
  std::vector<HalfSpace> kept;
  glm::dvec3 least, greatest;
  boxOf(grid, least, greatest);
  addBox(grid, least, greatest, kept);
  if (scene.crop) {
    const glm::dvec3 from = scene.crop->least.p, to = scene.crop->greatest.p;
    if (!finite(from) || !finite(to)) return invalid("/crop", "The crop box must be of finite numbers.");
    if (!glm::all(glm::lessThan(from, to)))
      return invalid("/crop", "The crop box is empty: 'from' must lie below 'to' along each axis.");
    addBox(grid, from, to, kept);
  }
  for (std::size_t n = 0; n < scene.clip.size(); ++n) {
    const HalfSpace& plane = scene.clip[n];
    const double length = glm::length(plane.normal.v);
    const std::string where = "/clip/" + std::to_string(n);
    if (!finite(plane.normal.v) || !std::isfinite(plane.offset_mm) || !(length > 0))
      return invalid(where, "A clip plane needs a finite normal other than 0 and a finite place.");
    kept.push_back({PatientVec(plane.normal.v / length), plane.offset_mm / length});
  }
  return kept;
}

RaySpan spanOf(const PatientRay& ray, const std::vector<HalfSpace>& region, double nearAlongRay_mm) {
  RaySpan span{std::max(0.0, nearAlongRay_mm), std::numeric_limits<double>::infinity()};
  for (const HalfSpace& h : region) {
    const double outside = h.distance_mm(ray.origin), slope = dot(h.normal, ray.direction);
    if (slope > 0)
      span.exit_mm = std::min(span.exit_mm, -outside / slope);
    else if (slope < 0)
      span.entry_mm = std::max(span.entry_mm, -outside / slope);
    else if (outside > 0)
      return {0, -1};
  }
  return span;
}

DepthRamp depthRamp(const CameraPicture& camera, const GridGeometry& grid, bool byDistance) {
  DepthRamp ramp{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), false};
  for (int n = 0; n < 8; ++n) {
    const double depth = dot(grid.corner(n) - camera.eye, camera.forward);
    ramp.near_mm = std::min(ramp.near_mm, depth), ramp.far_mm = std::max(ramp.far_mm, depth);
  }
  const bool perspective = camera.projection == Projection::Perspective;
  ramp.near_mm = std::max(ramp.near_mm, camera.near_mm);
  if (perspective) ramp.near_mm = std::max(ramp.near_mm, 1e-3 * ramp.far_mm);
  if (!(ramp.far_mm > ramp.near_mm)) ramp.far_mm = ramp.near_mm + 1;  // nothing of the box is seen
  ramp.afterProjection = perspective && !byDistance;
  return ramp;
}

VoiWindow wholeRange(const Volume& volume) {
  const Volume::Range r = volume.modalityRange().value_or(Volume::Range{0, 1});
  const double width = r.max > r.min ? r.max - r.min : 1;
  return {r.max > r.min ? 0.5 * (r.min + r.max) : r.min + 0.5, width, VoiFunction::LinearExact, "all values"};
}

double defaultGain_perMm(const GridGeometry& grid) { return 4 / cameraBox(grid).diagonal_mm; }

Result<std::vector<PlacedSurface>> placedSurfaces(const Scene& scene, const Sources& sources) {
  std::vector<PlacedSurface> out;
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const auto* layer = std::get_if<SurfaceLayer>(&scene.layers[i]);
    if (!layer) continue;
    const std::string where = "/layers/" + std::to_string(i);
    const auto found = sources.meshes.find(layer->source);
    if (found == sources.meshes.end() || !found->second)
      return invalid(where + "/source", "The surface that the layer names is not loaded.");
    if (const Result<void> ok = checkPose(layer->pose); !ok)
      return makeError(ok.error().code, ok.error().sentence, where + "/pose");
    if (!(layer->opacity >= 0 && layer->opacity <= 1))
      return invalid(where + "/opacity", "The opacity lies between 0 and 1.");
    out.push_back(
        {found->second, layer->pose, {layer->colour.r, layer->colour.g, layer->colour.b}, layer->opacity});
  }
  return out;
}

}  // namespace vernier
