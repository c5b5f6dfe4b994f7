// SPDX-License-Identifier: GPL-3.0-or-later
// What slices and curved reformats share in double: from a patient point, or the line across a slab there, to
// a modality value, and from there to grey.
#pragma once
#include <memory>
#include <string>

#include "Field.h"
#include "vernier/quality/Reference.h"

namespace vernier::quality {

class VolumeReading {
 public:
  // Of a SliceLayer or CurvedLayer: the volume, the window, what to do across the slab.
  template <class L>
  static Result<VolumeReading> make(const L& layer, const Sources& sources) {
    return make(layer.source, layer.slab, layer.interpolation, layer.window, layer.invert, sources);
  }

  const Volume& volume() const { return *volume_; }
  double thickness_mm() const { return slab_.thickness_mm; }
  int samplesFor(const ReferenceOptions&) const;  // 0: the continuous truth
  // `normal` is the unit direction across the slab, which is centred on the point. The truth, or with
  // samples > 0 the midpoint samples of a slab. nullopt: no data.
  std::optional<SliceValue> value(glm::dvec3 patient, glm::dvec3 normal, int samples) const;
  bool covers(glm::dvec3 patient, glm::dvec3 normal, int samples) const;
  // Of a colour volume: its red, green, blue and alpha, each by itself, over `background`. nullopt: no data.
  std::optional<glm::dvec3> colour(glm::dvec3 patient, glm::dvec3 normal, int samples,
                                   glm::dvec3 background) const;
  double grey(double modality) const;

 private:
  static Result<VolumeReading> make(const std::string& source, const Slab&, Interpolation,
                                    const std::optional<VoiWindow>&, bool invert, const Sources&);
  std::optional<SliceValue> valueIn(const Volume&, glm::dvec3 patient, glm::dvec3 normal, int samples) const;
  // The volume whose field says where there is data: a colour volume's first channel.
  const Volume& fieldVolume() const { return volume_->isColour() ? volume_->channel(0) : *volume_; }
  std::optional<double> sampled(const Field&, glm::dvec3 first_vox, glm::dvec3 step_vox, int samples,
                                LocalRange*) const;
  std::optional<double> continuous(const Field&, glm::dvec3 first_vox, glm::dvec3 step_vox,
                                   LocalRange*) const;

  std::shared_ptr<const Volume> volume_;
  Slab slab_;
  Interpolation interpolation_ = Interpolation::Linear;
  VoiWindow window_;
  bool invert_ = false;
};

}  // namespace vernier::quality
