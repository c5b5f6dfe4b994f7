// SPDX-License-Identifier: GPL-3.0-or-later
// One slice layer in double: from pixels to the patient, and what VolumeReading says there.
#pragma once
#include <utility>

#include "VolumeReading.h"

namespace vernier::quality {

class SliceReference {
 public:
  static Result<SliceReference> make(const Scene&, const SliceLayer&, const View&, const Sources&);

  glm::dvec3 patientAt(glm::dvec2 pixel) const { return corner_ + pixel.x * right_ + pixel.y * down_; }
  glm::dvec2 pixelOf(glm::dvec3 patient) const;
  const VolumeReading& reading() const { return reading_; }
  const Volume& volume() const { return reading_.volume(); }
  glm::dvec3 normal() const { return normal_; }

  std::optional<SliceValue> value(glm::dvec2 pixel, int samples) const {
    return reading_.value(patientAt(pixel), normal_, samples);
  }
  bool covers(glm::dvec2 pixel, int samples) const {
    return reading_.covers(patientAt(pixel), normal_, samples);
  }
  std::optional<glm::dvec3> colour(glm::dvec2 pixel, int samples, glm::dvec3 background) const {
    return reading_.colour(patientAt(pixel), normal_, samples, background);
  }

 private:
  SliceReference(VolumeReading reading, const Plane& plane) : reading_(std::move(reading)), plane_(plane) {}
  Result<void> place(const Camera&, const View&);
  glm::dvec2 reach_mm(glm::dvec3 right, glm::dvec3 up) const;

  VolumeReading reading_;
  Plane plane_;
  glm::dvec3 corner_{0}, right_{0}, down_{0}, normal_{0};  // patient mm; right and down per pixel
};

}  // namespace vernier::quality
