// SPDX-License-Identifier: GPL-3.0-or-later
#include "SliceReference.h"

#include <algorithm>
#include <cmath>

#include "Grey.h"
#include "vernier/volume/Build.h"

namespace vernier::quality {
namespace {

bool finite(glm::dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Error degenerate(std::string sentence) { return makeError(ErrorCode::PlaneDegenerate, std::move(sentence)); }

}  // namespace

int slabSamples(const Volume& volume, double thickness_mm, double step) {
  if (!(thickness_mm > 0)) return 1;
  const glm::dvec3 s = volume.grid().spacing_mm();
  return std::max(1, static_cast<int>(std::ceil(thickness_mm / (step * std::min({s.x, s.y, s.z})))));
}

Result<SliceReference> SliceReference::make(const Scene& scene, const SliceLayer& layer, const View& view,
                                            const Sources& sources) {
  const auto found = sources.volumes.find(layer.source);
  if (found == sources.volumes.end() || !found->second)
    return makeError(ErrorCode::SceneInvalid, "The layer's volume '" + layer.source + "' is not loaded.");
  if (!(layer.slab.thickness_mm >= 0) || !std::isfinite(layer.slab.thickness_mm))
    return makeError(ErrorCode::SceneInvalid, "The slab's thickness must be 0 mm or more, and finite.");
  SliceReference r;
  r.volume_ = found->second;
  r.layer_ = layer;
  r.window_ = layer.window.value_or(VoiWindow{});
  if (!layer.window) r.window_ = defaultWindow(*r.volume_);
  if (!(r.window_.width > 0) || !std::isfinite(r.window_.width) || !std::isfinite(r.window_.center))
    return makeError(ErrorCode::SceneInvalid, "The layer's window has no width; give a width above 0.");
  // One inversion in all: an inverted display of an inverted image is upright.
  r.invert_ = layer.invert != r.volume_->info().inverted;
  if (auto placed = r.place(scene.camera, view); !placed) return placed.error();
  return r;
}

Result<void> SliceReference::place(const Camera& camera, const View& view) {
  const Plane& plane = layer_.plane;
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
  const GridGeometry& g = volume_->grid();
  glm::dvec2 reach(0);
  const auto slice = [&](glm::dvec2 offset, double z) {
    for (int n = 0; n < 4; ++n) {
      const glm::dvec3 p_vox(offset.x + (n & 1 ? static_cast<double>(g.columns) - 0.5 : -0.5),
                             offset.y + (n & 2 ? static_cast<double>(g.rows) - 0.5 : -0.5), z);
      const glm::dvec3 d = (g.patientFromVoxel * VoxelPoint(p_vox)).p - layer_.plane.point.p;
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

int SliceReference::samplesFor(const ReferenceOptions& options) const {
  if (options.kind == ErrorKind::Model || thickness_mm() == 0) return 0;
  return slabSamples(*volume_, thickness_mm(), options.step);
}

std::optional<SliceValue> SliceReference::value(glm::dvec2 pixel, int samples) const {
  const VoxelFromPatient& toVoxel = volume_->voxelFromPatient();
  const glm::dvec3 p = patientAt(pixel);
  LocalRange range;
  std::optional<double> v;
  if (thickness_mm() == 0) {
    v = Field(*volume_, layer_.interpolation).at((toVoxel * PatientPoint(p)).p, &range);
  } else {
    const glm::dvec3 whole_mm = thickness_mm() * normal_;
    const glm::dvec3 first = (toVoxel * PatientPoint(p - 0.5 * whole_mm)).p;
    const glm::dvec3 step = (toVoxel * PatientVec(whole_mm)).v;
    v = samples > 0 ? sampled(first, step, samples, &range) : continuous(first, step, &range);
  }
  if (!v) return std::nullopt;
  return SliceValue{*v, range.min, range.max};
}

std::optional<double> SliceReference::sampled(glm::dvec3 first_vox, glm::dvec3 step_vox, int samples,
                                              LocalRange* range) const {
  const Field field(*volume_, layer_.interpolation);
  LocalRange extremes;
  double sum = 0;
  int valid = 0;
  for (int n = 0; n < samples; ++n) {
    const auto v = field.at(first_vox + (n + 0.5) / samples * step_vox, range);
    if (!v) continue;
    extremes.add(*v);
    sum += *v;
    ++valid;
  }
  if (valid == 0) return std::nullopt;
  switch (layer_.slab.mode) {
    case SlabMode::Max:
      return extremes.max;
    case SlabMode::Min:
      return extremes.min;
    case SlabMode::Mean:
      break;
  }
  return sum / valid;
}

std::optional<double> SliceReference::continuous(glm::dvec3 first_vox, glm::dvec3 step_vox,
                                                 LocalRange* range) const {
  const bool mean = layer_.slab.mode == SlabMode::Mean;
  LocalRange extremes;
  double sum = 0, length = 0;
  Field(*volume_, layer_.interpolation).alongLine(first_vox, step_vox, range, [&](const Piece& piece) {
    const double l = piece.end - piece.begin;
    length += l;
    if (mean) {
      sum += l * piece.mean();
    } else {
      const LocalRange e = piece.extremes();
      extremes.add(e.min);
      extremes.add(e.max);
    }
    return true;
  });
  if (!(length > 0)) return std::nullopt;
  if (mean) return sum / length;
  return layer_.slab.mode == SlabMode::Max ? extremes.max : extremes.min;
}

bool SliceReference::covers(glm::dvec2 pixel, int samples) const {
  if (thickness_mm() == 0 || samples > 0) return value(pixel, samples).has_value();
  const VoxelFromPatient& toVoxel = volume_->voxelFromPatient();
  const Field field(*volume_, layer_.interpolation);
  // Nearly always the middle of the slab tells already.
  if (field.at((toVoxel * PatientPoint(patientAt(pixel))).p)) return true;
  const glm::dvec3 whole_mm = thickness_mm() * normal_;
  bool any = false;
  field.alongLine((toVoxel * PatientPoint(patientAt(pixel) - 0.5 * whole_mm)).p,
                  (toVoxel * PatientVec(whole_mm)).v, nullptr, [&](const Piece&) {
                    any = true;
                    return false;
                  });
  return any;
}

double SliceReference::grey(double modality) const {
  const double g = windowGrey(window_, modality);
  return invert_ ? 1 - g : g;
}

}  // namespace vernier::quality
