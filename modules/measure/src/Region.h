// SPDX-License-Identifier: GPL-3.0-or-later
// A flat region: its outline in the picture's plane, and the raster of values inside it.
#pragma once
#include "Work.h"
#include "vernier/measure/Statistics.h"

namespace vernier::measure {

// Coordinates in the plane, in the unit of the answer: p = origin + x right + y up.
struct Flat {
  glm::dvec3 origin{0}, right{1, 0, 0}, up{0, 1, 0};
  std::vector<glm::dvec2> outline;  // of a polygon; of an ellipse: the corners of its box, in turn
  bool ellipse = false;
  glm::dvec2 toFlat(glm::dvec3 p) const { return {glm::dot(p - origin, right), glm::dot(p - origin, up)}; }
  glm::dvec3 toSpace(glm::dvec2 q) const { return origin + q.x * right + q.y * up; }
};

// A map of the plane's coordinates onto a raster's: pixel (i, j) has its centre at (i + 0.5, j + 0.5).
struct RasterMap {
  glm::dmat2 linear{1};
  glm::dvec2 translation{0};
  glm::dvec2 operator*(glm::dvec2 p) const { return linear * p + translation; }
};

// For each row the closed spans of the region in a raster's coordinates.
std::vector<std::pair<double, double>> spansOf(const Flat&, const RasterMap&, double y);
// The box of the region in a raster's coordinates.
struct Box {
  glm::dvec2 low, high;
};
Box boxOf(const Flat&, const RasterMap&);

// The slice that the plane lies in, to a thousandth of a step at every corner; nullopt: none, or colour.
std::optional<std::int64_t> acquiredSlice(const Volume&, const Flat&);

// What stands inside: NaN where not inside or no data.
struct Inside {
  Raster raster;
  std::uint64_t noData = 0;
  double step = 0;  // of stored values
  bool interpolated = false;
};
Inside valuesInside(const Work&, const Flat&);

// The outline of what reaches the level around the seed (Contour.cpp); fills Measured::found.
Flat thresholdRegion(Work&, const ThresholdRegion&);

}  // namespace vernier::measure
