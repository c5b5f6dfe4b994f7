// SPDX-License-Identifier: GPL-3.0-or-later
#include "VolumeReading.h"

#include <algorithm>
#include <cmath>

#include "Grey.h"
#include "vernier/volume/Build.h"

namespace vernier::quality {

int slabSamples(const Volume& volume, double thickness_mm, double step) {
  if (!(thickness_mm > 0)) return 1;
  const glm::dvec3 s = volume.grid().spacing_mm();
  return std::max(1, static_cast<int>(std::ceil(thickness_mm / (step * std::min({s.x, s.y, s.z})))));
}

Result<VolumeReading> VolumeReading::make(const std::string& source, const Slab& slab,
                                          Interpolation interpolation, const std::optional<VoiWindow>& window,
                                          bool invert, const Sources& sources) {
  const auto found = sources.volumes.find(source);
  if (found == sources.volumes.end() || !found->second)
    return makeError(ErrorCode::SceneInvalid, "The layer's volume '" + source + "' is not loaded.");
  if (!(slab.thickness_mm >= 0) || !std::isfinite(slab.thickness_mm))
    return makeError(ErrorCode::SceneInvalid, "The slab's thickness must be 0 mm or more, and finite.");
  VolumeReading r;
  r.volume_ = found->second;
  r.slab_ = slab;
  r.interpolation_ = interpolation;
  r.window_ = window && !r.volume_->isColour() ? *window : defaultWindow(*r.volume_);
  if (!(r.window_.width > 0) || !std::isfinite(r.window_.width) || !std::isfinite(r.window_.center))
    return makeError(ErrorCode::SceneInvalid, "The layer's window has no width; give a width above 0.");
  // One inversion in all: an inverted display of an inverted image is upright.
  r.invert_ = invert != r.volume_->info().inverted;
  return r;
}

int VolumeReading::samplesFor(const ReferenceOptions& options) const {
  if (options.kind == ErrorKind::Model || thickness_mm() == 0) return 0;
  return slabSamples(*volume_, thickness_mm(), options.step);
}

std::optional<SliceValue> VolumeReading::value(glm::dvec3 p, glm::dvec3 normal, int samples) const {
  return volume_->isColour() ? std::nullopt : valueIn(*volume_, p, normal, samples);
}

std::optional<glm::dvec3> VolumeReading::colour(glm::dvec3 p, glm::dvec3 normal, int samples,
                                                glm::dvec3 background) const {
  glm::dvec4 rgba(0, 0, 0, 1);
  for (int c = 0; c < volume_->info().channels; ++c) {
    const auto v = valueIn(volume_->channel(c), p, normal, samples);
    if (!v) return std::nullopt;
    rgba[c] = v->value / 255;
  }
  const glm::dvec3 rgb = invert_ ? 1.0 - glm::dvec3(rgba) : glm::dvec3(rgba);
  return rgba.w * rgb + (1 - rgba.w) * background;
}

std::optional<SliceValue> VolumeReading::valueIn(const Volume& volume, glm::dvec3 p, glm::dvec3 normal,
                                                 int samples) const {
  const Field field(volume, interpolation_);
  const VoxelFromPatient& toVoxel = volume_->voxelFromPatient();
  LocalRange range;
  std::optional<double> v;
  if (thickness_mm() == 0) {
    v = field.at((toVoxel * PatientPoint(p)).p, &range);
  } else {
    const glm::dvec3 whole_mm = thickness_mm() * normal;
    const glm::dvec3 first = (toVoxel * PatientPoint(p - 0.5 * whole_mm)).p;
    const glm::dvec3 step = (toVoxel * PatientVec(whole_mm)).v;
    v = samples > 0 ? sampled(field, first, step, samples, &range) : continuous(field, first, step, &range);
  }
  if (!v) return std::nullopt;
  return SliceValue{*v, range.min, range.max};
}

std::optional<double> VolumeReading::sampled(const Field& field, glm::dvec3 first_vox, glm::dvec3 step_vox,
                                             int samples, LocalRange* range) const {
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
  switch (slab_.mode) {
    case SlabMode::Max:
      return extremes.max;
    case SlabMode::Min:
      return extremes.min;
    case SlabMode::Mean:
      break;
  }
  return sum / valid;
}

std::optional<double> VolumeReading::continuous(const Field& field, glm::dvec3 first_vox, glm::dvec3 step_vox,
                                                LocalRange* range) const {
  const bool mean = slab_.mode == SlabMode::Mean;
  LocalRange extremes;
  double sum = 0, length = 0;
  field.alongLine(first_vox, step_vox, range, [&](const Piece& piece) {
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
  return slab_.mode == SlabMode::Max ? extremes.max : extremes.min;
}

bool VolumeReading::covers(glm::dvec3 p, glm::dvec3 normal, int samples) const {
  if (thickness_mm() == 0 || samples > 0) return valueIn(fieldVolume(), p, normal, samples).has_value();
  const VoxelFromPatient& toVoxel = volume_->voxelFromPatient();
  const Field field(fieldVolume(), interpolation_);
  // Nearly always the middle of the slab tells already.
  if (field.at((toVoxel * PatientPoint(p)).p)) return true;
  const glm::dvec3 whole_mm = thickness_mm() * normal;
  bool any = false;
  field.alongLine((toVoxel * PatientPoint(p - 0.5 * whole_mm)).p, (toVoxel * PatientVec(whole_mm)).v, nullptr,
                  [&](const Piece&) {
                    any = true;
                    return false;
                  });
  return any;
}

double VolumeReading::grey(double modality) const {
  const double g = windowGrey(window_, modality);
  return invert_ ? 1 - g : g;
}

}  // namespace vernier::quality
