// SPDX-License-Identifier: GPL-3.0-or-later
#include "SliceReference.h"

#include <algorithm>
#include <cmath>

namespace vernier::quality {
namespace {

bool finite(glm::dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Error degenerate(std::string sentence) { return makeError(ErrorCode::PlaneDegenerate, std::move(sentence)); }

}  // namespace

Result<SliceReference> SliceReference::make(const Scene& scene, const SliceLayer& layer, const View& view,
                                            const Sources& sources) {
  auto reading = VolumeReading::make(layer, sources);
  if (!reading) return reading.error();
  SliceReference r(std::move(*reading), layer.plane);
  if (auto placed = r.place(scene.camera, view); !placed) return placed.error();
  return r;
}

Result<void> SliceReference::addLens(std::shared_ptr<const ConvexRegion> region, const SliceLayer& base,
                                     const LensInner& inner, const Sources& sources) {
  if (std::holds_alternative<CutOut>(inner)) {
    lenses_.push_back({std::move(region), std::nullopt});
    return {};
  }
  const auto* look = std::get_if<SliceLook>(&inner);
  if (!look)
    return makeError(ErrorCode::SceneInvalid,
                     "On a slice a lens shows 'slice' (another window) or 'cut-out'.");
  SliceLayer layer = base;
  layer.interpolation = look->interpolation, layer.window = look->window, layer.invert = look->invert;
  auto reading = VolumeReading::make(layer, sources);
  if (!reading) return reading.error();
  lenses_.push_back({std::move(region), *std::move(reading)});
  return {};
}

std::size_t SliceReference::lensAt(glm::dvec2 pixel) const {
  for (std::size_t n = lenses_.size(); n > 0; --n)
    if (lenses_[n - 1].region->contains(PatientPoint(patientAt(pixel)))) return n;
  return 0;
}

Result<void> SliceReference::place(const Camera& camera, const View& view) {
  const Plane& plane = plane_;
  if (!finite(plane.point.p) || !finite(plane.normal.v) || !finite(plane.up.v))
    return degenerate("The plane is not finite; give numbers for its point, normal and up.");
  const double nn = glm::length(plane.normal.v), uu = glm::length(plane.up.v);
  if (!(nn > 0) || !(uu > 0)) return degenerate("The plane's normal or up vector has no length.");
  normal_ = plane.normal.v / nn;
  const glm::dvec3 upUnit = plane.up.v / uu;
  const glm::dvec3 inPlane = upUnit - glm::dot(upUnit, normal_) * normal_;
  if (!(glm::length(glm::cross(upUnit, normal_)) >= 1e-6))
    return degenerate("The plane's up vector is parallel to its normal.");
  const glm::dvec3 up = glm::normalize(inPlane), right = glm::cross(up, normal_);
  const double w = view.width_px, h = view.height_px;
  double mmPerPixel = 0;
  if (camera.height_mm) {
    mmPerPixel = *camera.height_mm / h;
  } else {
    const glm::dvec2 reach = reach_mm(right, up);
    mmPerPixel = std::max(2 * reach.x / w, 2 * reach.y / h);
  }
  mmPerPixel /= camera.zoom;
  if (!(mmPerPixel > 0) || !std::isfinite(mmPerPixel))
    return makeError(ErrorCode::SceneInvalid, "The camera's zoom or height gives no finite picture scale.");
  right_ = mmPerPixel * right;
  down_ = -mmPerPixel * up;
  const glm::dvec3 centre = plane.point.p + camera.pan_mm.x * right + camera.pan_mm.y * up;
  corner_ = centre - 0.5 * w * right_ - 0.5 * h * down_;
  return {};
}

// How far the voxels' outer faces reach from the plane's point, along right and up.
glm::dvec2 SliceReference::reach_mm(glm::dvec3 right, glm::dvec3 up) const {
  const GridGeometry& g = volume().grid();
  glm::dvec2 reach(0);
  const auto slice = [&](glm::dvec2 offset, double z) {
    for (int n = 0; n < 4; ++n) {
      const glm::dvec3 p_vox(offset.x + (n & 1 ? static_cast<double>(g.columns) - 0.5 : -0.5),
                             offset.y + (n & 2 ? static_cast<double>(g.rows) - 0.5 : -0.5), z);
      const glm::dvec3 d = (g.patientFromVoxel * VoxelPoint(p_vox)).p - plane_.point.p;
      reach = glm::max(reach, glm::dvec2(std::abs(glm::dot(d, right)), std::abs(glm::dot(d, up))));
    }
  };
  for (std::int64_t s = 0; s < g.slices; ++s) {
    const glm::dvec3 o =
        g.even() ? glm::dvec3(0, 0, static_cast<double>(s)) : g.sliceOrigin_vox[static_cast<std::size_t>(s)];
    const double before = s == 0 ? 0.5 : 0, after = s + 1 == g.slices ? 0.5 : 0;
    slice(glm::dvec2(o), o.z - before);
    slice(glm::dvec2(o), o.z + after);
  }
  return reach;
}

glm::dvec2 SliceReference::pixelOf(glm::dvec3 patient) const {
  const glm::dvec3 d = patient - corner_;
  return {glm::dot(d, right_) / glm::dot(right_, right_), glm::dot(d, down_) / glm::dot(down_, down_)};
}

}  // namespace vernier::quality
