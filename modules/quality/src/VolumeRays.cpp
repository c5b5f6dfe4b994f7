// SPDX-License-Identifier: GPL-3.0-or-later
#include "VolumeRays.h"

#include <cmath>

#include "vernier/plan/Volumetric.h"

namespace vernier::quality {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A ray that changes a bound's value by less than this per mm runs along it, and may lie past it by rounding.
constexpr double kParallel = 1e-12, kSlack = kBorderSlack_vox;

Error invalid(const std::string& where, const std::string& sentence) {
  return makeError(ErrorCode::SceneInvalid, sentence, where);
}

bool finite(glm::dvec3 v) { return std::isfinite(v.x + v.y + v.z); }

std::array<glm::dvec3, 8> cornersOf(const GridGeometry& g) {
  std::array<glm::dvec3, 8> out;
  for (std::size_t n = 0; n < 8; ++n) {
    const glm::dvec3 voxel(n & 1 ? static_cast<double>(g.columns - 1) : 0,
                           n & 2 ? static_cast<double>(g.rows - 1) : 0,
                           n & 4 ? g.lastPosition_vox() : g.firstPosition_vox());
    out[n] = g.patientFromVoxel.linear * voxel + g.patientFromVoxel.translation;
  }
  return out;
}

}  // namespace

CentreBox centreBox(const GridGeometry& g) {
  glm::dvec2 low(0), high(0);
  for (const glm::dvec3& o : g.sliceOrigin_vox)
    low = glm::min(low, glm::dvec2(o)), high = glm::max(high, glm::dvec2(o));
  const glm::dvec2 last(static_cast<double>(g.columns - 1), static_cast<double>(g.rows - 1));
  return {{low, g.firstPosition_vox()}, {last + high, g.lastPosition_vox()}};
}

Result<std::vector<VolumeRays::Bound>> VolumeRays::boundsOf(const Scene& scene, const GridGeometry& g) {
  std::vector<Bound> out;
  const glm::dmat3 normals = glm::transpose(glm::inverse(g.patientFromVoxel.linear));
  const auto addBox = [&](glm::dvec3 least, glm::dvec3 greatest, Border border) {
    for (int axis = 0; axis < 3; ++axis)
      for (double side : {-1.0, 1.0}) {
        Bound b;
        b.gradient[axis] = side;
        b.offset = side > 0 ? greatest[axis] : -least[axis];
        b.normal = side * glm::normalize(normals[axis]);
        b.border = border;
        out.push_back(b);
      }
  };
  const CentreBox box = centreBox(g);
  addBox(box.least, box.greatest, Border::Box);
  if (scene.crop) {
    const glm::dvec3 from = scene.crop->least.p, to = scene.crop->greatest.p;
    if (!finite(from) || !finite(to) || !(from.x < to.x && from.y < to.y && from.z < to.z))
      return invalid("/crop", "The crop box must be finite, and 'from' below 'to' along each axis.");
    addBox(from, to, Border::Cut);
  }
  for (std::size_t n = 0; n < scene.clip.size(); ++n) {
    const HalfSpace& plane = scene.clip[n];
    const double length = glm::length(plane.normal.v);
    if (!finite(plane.normal.v) || !std::isfinite(plane.offset_mm) || !(length > 0))
      return invalid("/clip/" + std::to_string(n), "A clip plane needs a finite normal other than 0.");
    const glm::dvec3 unit = plane.normal.v / length;
    out.push_back({false, unit, plane.offset_mm / length, unit, Border::Cut});
  }
  return out;
}

VolumeRays::Fall VolumeRays::fallOf(const RayCamera& camera, const GridGeometry& g) {
  Fall f{kInfinity, -kInfinity, camera.perspective};
  for (const glm::dvec3& corner : cornersOf(g)) {
    f.near_mm = std::min(f.near_mm, camera.depth(corner));
    f.far_mm = std::max(f.far_mm, camera.depth(corner));
  }
  f.near_mm = std::max(f.near_mm, camera.near_mm);
  if (camera.perspective) f.near_mm = std::max(f.near_mm, f.far_mm / 1000);
  if (!(f.far_mm > f.near_mm)) f.far_mm = f.near_mm + 1;  // nothing of the box is before the eye
  return f;
}

Result<VolumeRays> VolumeRays::make(const Scene& scene, const std::string& source,
                                    Interpolation interpolation, const std::optional<VoiWindow>& window,
                                    const View& view, const Sources& sources, Colours colours) {
  const auto found = sources.volumes.find(source);
  if (found == sources.volumes.end() || !found->second)
    return makeError(ErrorCode::SceneInvalid, "The layer's volume '" + source + "' is not loaded.");
  const Volume& volume = *found->second;
  if (volume.isColour() && colours == Colours::Refused)
    return makeError(
        ErrorCode::SceneInvalid,
        "The layer's volume is in colour and has no values to look through for; show it as slices.");
  if (interpolation == Interpolation::Cubic)
    return makeError(ErrorCode::SceneInvalid, "Looks through a volume interpolate with nearest or linear.");
  const GridGeometry& g = volume.grid();
  if (g.columns < 2 || g.rows < 2 || g.slices < 2)
    return makeError(ErrorCode::GeometryRefused,
                     "The volume is a single slice, row or column, which has no inside to look through; show "
                     "it as a slice.");
  auto bounds = boundsOf(scene, g);
  if (!bounds) return bounds.error();
  const std::array<glm::dvec3, 8> corners = cornersOf(g);
  double diagonal = 0;
  for (std::size_t n = 0; n < 4; ++n) diagonal = std::max(diagonal, glm::length(corners[n] - corners[7 - n]));
  const auto camera = RayCamera::make(scene.camera, view, 0.5 * (corners[0] + corners[7]), diagonal);
  if (!camera) return camera.error();
  auto surfaces = SurfaceReference::make(scene, view, sources, &*camera);
  if (!surfaces) return surfaces.error();
  VolumeRays r(std::move(*surfaces));
  r.volume_ = found->second;
  r.field_ = volume.isColour() ? &volume.channel(volume.info().channels == 4 ? 3 : 0) : &volume;
  r.interpolation_ = interpolation;
  r.window_ = window && !volume.isColour() ? *window : wholeRange(*r.field_);
  if (!(r.window_.width > 0) || !std::isfinite(r.window_.width) || !std::isfinite(r.window_.center))
    return makeError(ErrorCode::SceneInvalid, "The layer's window has no width; give a width above 0.");
  r.camera_ = *camera;
  r.bounds_ = std::move(*bounds);
  r.diagonal_mm_ = diagonal;
  r.fall_ = fallOf(*camera, g);
  return r;
}

void VolumeRays::keep(VolumeRay& ray) const {
  ray.begin_mm = std::max(0.0, camera_.near_mm / ray.line.depthPerMm);
  ray.end_mm = kInfinity;
  ray.begunBy = Border::Near;
  ray.beginNormal = -camera_.forward;
  const glm::dvec3 origin = voxelAt(ray, 0), perMm = volume_->voxelFromPatient().linear * ray.line.direction;
  for (const Bound& b : bounds_) {
    const double value = glm::dot(b.gradient, b.inVoxels ? origin : ray.line.origin) - b.offset;
    const double slope = glm::dot(b.gradient, b.inVoxels ? perMm : ray.line.direction);
    if (std::abs(slope) <= kParallel) {
      if (value > kSlack) ray.end_mm = -kInfinity;
    } else if (slope > 0) {
      if (-value / slope < ray.end_mm) ray.end_mm = -value / slope, ray.endedBy = b.border;
    } else if (-value / slope > ray.begin_mm) {
      ray.begin_mm = -value / slope, ray.begunBy = b.border, ray.beginNormal = b.normal;
    }
  }
}

bool VolumeRays::keepsNoneOf(const std::array<glm::dvec3, 8>& corners_vox) const {
  std::array<glm::dvec3, 8> patient;
  for (std::size_t n = 0; n < 8; ++n)
    patient[n] = (volume_->grid().patientFromVoxel * VoxelPoint(corners_vox[n])).p;
  const auto all = [](const auto& corners, auto&& outside) {
    return std::all_of(corners.begin(), corners.end(), outside);
  };
  for (const Bound& b : bounds_)
    if (all(b.inVoxels ? corners_vox : patient,
            [&](glm::dvec3 p) { return glm::dot(b.gradient, p) - b.offset > kSlack; }))
      return true;
  return all(patient,
             [&](glm::dvec3 p) { return camera_.depth(p) < std::max(0.0, camera_.near_mm) - kSlack; });
}

VolumeRay VolumeRays::ray(glm::dvec2 pixel) const {
  VolumeRay ray;
  ray.line = camera_.ray(pixel);
  keep(ray);
  ray.through = {1};
  for (const SurfaceHit& hit : surfaces_.hits(pixel)) {
    const SurfaceReference::Look look = surfaces_.lookOf(hit);
    if (look.opacity >= 1) {
      ray.opaque = RayTool{hit.t_mm, look.colour, 1};
      ray.opaqueLayer = hit.layer;
      if (hit.t_mm < ray.end_mm) ray.end_mm = hit.t_mm, ray.endedBy = Border::Tool;
      break;
    }
    ray.tools.push_back({hit.t_mm, look.colour, look.opacity});
    ray.through.push_back(ray.through.back() * (1 - look.opacity));
  }
  return ray;
}

std::uint64_t VolumeRays::edgeKey(const VolumeRay& ray, bool shown) {
  std::uint64_t key = shown ? 1 : 0;
  if (ray.begin_mm < ray.end_mm) {
    key |= (ray.begunBy == Border::Cut ? 2u : 0u) | (ray.endedBy == Border::Cut ? 4u : 0u) |
           (ray.endedBy == Border::Tool ? 8u : 0u);
  }
  return key | (ray.tools.size() << 4) | ((ray.opaque ? ray.opaqueLayer + 1 : 0) << 32);
}

// Where the depth cue stops to change and where translucent tools stand, within the ray's part.
std::vector<double> VolumeRays::stopsOf(const VolumeRay& ray) const {
  std::vector<double> stops{ray.begin_mm, ray.end_mm};
  const auto cutAt = [&](double t) {
    if (t > ray.begin_mm && t < ray.end_mm) stops.push_back(t);
  };
  cutAt(fall_.near_mm / ray.line.depthPerMm);
  cutAt(fall_.far_mm / ray.line.depthPerMm);
  for (const RayTool& tool : ray.tools) cutAt(tool.t_mm);
  std::sort(stops.begin(), stops.end());
  return stops;
}

double VolumeRays::z(const VolumeRay& ray, double t_mm) const {
  const double n = fall_.near_mm, f = fall_.far_mm;
  const double depth = std::clamp(t_mm * ray.line.depthPerMm, n, f);
  return fall_.projected ? n * (f - depth) / (depth * (f - n)) : (f - depth) / (f - n);
}

Cue VolumeRays::cue(const VolumeRay& ray, const RayPart& part, double k0, double k1) const {
  const double n = fall_.near_mm, f = fall_.far_mm, perMm = ray.line.depthPerMm;
  const double a = part.begin_mm * perMm, b = part.end_mm * perMm, mid = 0.5 * (a + b);
  if (k1 == 0 || mid <= n || mid >= f) return {Poly{{k0 + k1 * z(ray, part.at(0.5))}, 0}, Poly{{1}, 0}};
  if (!fall_.projected) return {line(k0 + k1 * (f - a) / (f - n), k0 + k1 * (f - b) / (f - n)), Poly{{1}, 0}};
  // (k0 + k1 z') depth is linear in depth.
  const auto times = [&](double depth) { return k0 * depth + k1 * n * (f - depth) / (f - n); };
  return {line(times(a), times(b)), line(a, b)};
}

glm::dvec3 VolumeRays::gradient(const VolumeRay& ray, double t_mm, double cell_mm) const {
  const Field field(*field_, interpolation_);
  const glm::dvec3 perVoxel = field.gradient(voxelAt(ray, t_mm), voxelAt(ray, cell_mm));
  const glm::dvec3 patient = glm::transpose(volume_->voxelFromPatient().linear) * perVoxel;
  const double size = glm::length(patient);
  return size > 0 && std::isfinite(size) ? patient / size : glm::dvec3(0);
}

}  // namespace vernier::quality
