// SPDX-License-Identifier: GPL-3.0-or-later
// What one measurement works with: its data, its points in the unit of its answer, and how uncertain a point
// is.
#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "vernier/measure/Measure.h"

namespace vernier::measure {

struct Refused {  // thrown within the module, an Error outside
  Error error;
};
[[noreturn]] void refuse(std::string sentence);

struct Work {
  const Measurement& what;
  const Sources& sources;
  std::stop_token stop;
  std::shared_ptr<const ImageFrame> image;  // image space
  std::shared_ptr<const Volume> volume;     // patient space; null where it is not needed and not there
  Measured out;

  // Points in the unit of the answer: scaled pixels (z = 0), or mm of the patient.
  glm::dvec3 scale{1};      // image space: unit per pixel
  std::string unit = "mm";  // "mm" or "px"
  glm::dmat3 covariance{0};
  bool known = true;                    // false: no +/- can be stated
  std::optional<Placement::Axes> axes;  // unit vectors, up at right angles to normal; image space: x and y

  glm::dvec3 point(const Spot& p) const { return p * scale; }
  bool projected() const { return what.on.shown != Shown::Slice; }
  std::string name(const char* plain) const {
    return projected() ? std::string("projected ") + plain : plain;
  }
  std::optional<double> expanded(double variance) const {
    return known ? std::optional(2 * std::sqrt(std::max(0.0, variance))) : std::nullopt;
  }
  double quadratic(glm::dvec3 g) const { return glm::dot(g, covariance * g); }
  double worstVariance() const;  // of a point, in its worst direction
  void add(std::string quantity, double value, std::string ofUnit, std::optional<double> u) {
    out.quantities.push_back({std::move(quantity), value, std::move(ofUnit), u});
  }
  void note(std::string text);
};

// Loads the data, finds unit, origin and covariance for these points.
void prepare(Work&, std::span<const Spot> points);
// Notes a way that leads over missing slices.
void noteGaps(Work&, std::span<const Spot> points);
glm::dvec3 screenRight(const Placement::Axes&);  // up x normal

// Fills Work::out.
void measureLines(Work&);   // length, bidirectional, angle, Cobb
void measureRegion(Work&);  // rectangle, ellipse, polygon, freehand, threshold
void measureProbe(Work&);
void measureSurfaces(Work&);  // distances, volume of a mesh
void measureVolume(Work&);    // iso-region, convex region

}  // namespace vernier::measure
