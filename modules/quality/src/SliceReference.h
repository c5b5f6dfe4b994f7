// SPDX-License-Identifier: GPL-3.0-or-later
// One slice layer in double: from pixels to the patient, and what VolumeReading says there.
#pragma once
#include <utility>
#include <vector>

#include "VolumeReading.h"
#include "vernier/base/ConvexRegion.h"

namespace vernier::quality {

class SliceReference {
 public:
  static Result<SliceReference> make(const Scene&, const SliceLayer&, const View&, const Sources&);

  glm::dvec3 patientAt(glm::dvec2 pixel) const { return corner_ + pixel.x * right_ + pixel.y * down_; }
  glm::dvec2 pixelOf(glm::dvec3 patient) const;
  const VolumeReading& reading() const { return reading_; }
  const Volume& volume() const { return reading_.volume(); }
  glm::dvec3 normal() const { return normal_; }

  // Lenses, in the scene's order: what the plane cuts from them has another look, or is left out. A point on
  // a face is inside. PlaneDegenerate and SceneInvalid as `make`.
  Result<void> addLens(std::shared_ptr<const ConvexRegion>, const SliceLayer& base, const LensInner&,
                       const Sources&);
  // The lens that the pixel's point is in, from 1; 0: none.
  std::size_t lensAt(glm::dvec2 pixel) const;
  // nullptr: nothing is shown there.
  const VolumeReading* readingAt(glm::dvec2 pixel) const {
    const std::size_t lens = lensAt(pixel);
    return lens == 0 ? &reading_ : lenses_[lens - 1].look ? &*lenses_[lens - 1].look : nullptr;
  }

  std::optional<SliceValue> value(glm::dvec2 pixel, int samples) const {
    const VolumeReading* r = readingAt(pixel);
    return r ? r->value(patientAt(pixel), normal_, samples) : std::nullopt;
  }
  bool covers(glm::dvec2 pixel, int samples) const {
    const VolumeReading* r = readingAt(pixel);
    return r && r->covers(patientAt(pixel), normal_, samples);
  }
  std::optional<glm::dvec3> colour(glm::dvec2 pixel, int samples, glm::dvec3 background) const {
    const VolumeReading* r = readingAt(pixel);
    return r ? r->colour(patientAt(pixel), normal_, samples, background) : std::nullopt;
  }

 private:
  SliceReference(VolumeReading reading, const Plane& plane) : reading_(std::move(reading)), plane_(plane) {}
  Result<void> place(const Camera&, const View&);
  glm::dvec2 reach_mm(glm::dvec3 right, glm::dvec3 up) const;

  struct Lens {
    std::shared_ptr<const ConvexRegion> region;
    std::optional<VolumeReading> look;  // absent: cut out
  };
  VolumeReading reading_;
  std::vector<Lens> lenses_;
  Plane plane_;
  glm::dvec3 corner_{0}, right_{0}, down_{0}, normal_{0};  // patient mm; right and down per pixel
};

}  // namespace vernier::quality
