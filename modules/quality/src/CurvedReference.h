// SPDX-License-Identifier: GPL-3.0-or-later
// One curved reformat in double, by means of its own: the path as polynomials from Lagrange's form, arc
// length and the frame that does not turn about the path by integrating their differential equations
// (Runge-Kutta). CurvedGeometry.h of module plan says what is meant.
#pragma once
#include <utility>
#include <vector>

#include "VolumeReading.h"

namespace vernier::quality {

class CurvedReference {
 public:
  static Result<CurvedReference> make(const Scene&, const CurvedLayer&, const View&, const Sources&);

  const VolumeReading& reading() const { return reading_; }
  const Volume& volume() const { return reading_.volume(); }
  std::optional<SliceValue> value(glm::dvec2 pixel, int samples) const;
  bool covers(glm::dvec2 pixel, int samples) const;

  // The line of a column, with the picture's own columns and one more on each side; nullopt beyond the path.
  struct Column {
    glm::dvec3 top, down, normal;      // patient; y pixels below the picture's top: top + y * down
    double firstRow = 0, lastRow = 0;  // the sheet's borders, picture coordinates
  };
  std::optional<Column> columnAt(int x) const;

 private:
  CurvedReference(VolumeReading reading, const CurvedLayer& layer)
      : reading_(std::move(reading)), layer_(layer) {}
  Result<void> place(const Camera&, const View&);
  std::optional<glm::dvec3> pointAt(glm::dvec2 pixel, glm::dvec3& normal) const;

  VolumeReading reading_;
  CurvedLayer layer_;
  std::vector<std::optional<Column>> columns_;  // from x = -1
};

}  // namespace vernier::quality
