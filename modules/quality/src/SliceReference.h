// SPDX-License-Identifier: GPL-3.0-or-later
// One slice layer in double: from pixels to the patient, from the patient to a modality value, from there to
// grey.
#pragma once
#include <memory>
#include <string>

#include "Field.h"
#include "vernier/quality/Reference.h"

namespace vernier::quality {

class SliceReference {
 public:
  static Result<SliceReference> make(const Scene&, const SliceLayer&, const View&, const Sources&);

  glm::dvec3 patientAt(glm::dvec2 pixel) const { return corner_ + pixel.x * right_ + pixel.y * down_; }
  glm::dvec2 pixelOf(glm::dvec3 patient) const;
  const Volume& volume() const { return *volume_; }
  double thickness_mm() const { return layer_.slab.thickness_mm; }
  glm::dvec3 normal() const { return normal_; }

  // The truth, or with samples > 0 the midpoint samples of a slab. nullopt: no data.
  std::optional<SliceValue> value(glm::dvec2 pixel, int samples) const;
  bool covers(glm::dvec2 pixel, int samples) const;
  int samplesFor(const ReferenceOptions&) const;  // 0: the continuous truth
  double grey(double modality) const;

 private:
  SliceReference() = default;
  Result<void> place(const Camera&, const View&);
  glm::dvec2 reach_mm(glm::dvec3 right, glm::dvec3 up) const;
  std::optional<double> sampled(glm::dvec3 first_vox, glm::dvec3 step_vox, int samples, LocalRange*) const;
  std::optional<double> continuous(glm::dvec3 first_vox, glm::dvec3 step_vox, LocalRange*) const;

  std::shared_ptr<const Volume> volume_;
  SliceLayer layer_;
  VoiWindow window_;
  bool invert_ = false;
  glm::dvec3 corner_{0}, right_{0}, down_{0}, normal_{0};  // patient mm; right and down per pixel
};

}  // namespace vernier::quality
