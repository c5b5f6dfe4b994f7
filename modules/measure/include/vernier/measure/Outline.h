// SPDX-License-Identifier: GPL-3.0-or-later
// Closed outlines in a plane, in double. No sign: clockwise and counter-clockwise are the same. Where an
// outline crosses itself the even-odd rule says what is inside.
#pragma once
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "vernier/base/Api.h"

namespace vernier::measure {

// Whether two edges that are not neighbours touch, or neighbours fold back onto each other.
VERNIER_API bool crossesItself(std::span<const glm::dvec2>);

// Shoelace about the first corner, so that a large offset costs no digits; of an outline that crosses itself
// the even-odd area, by strips between all corners and crossings.
VERNIER_API double areaOf(std::span<const glm::dvec2>);
VERNIER_API double lengthOf(std::span<const glm::dvec2>);  // closed

// Calls visit(i) for each whole i in [0, columns) whose centre i + 0.5 in row j (at j + 0.5) lies inside. The
// edge counts as inside, and 1e-9 beyond it.
class VERNIER_API RowSpans {
 public:
  explicit RowSpans(std::span<const glm::dvec2> outline);
  struct Span {
    double from, to;  // closed
  };
  // Disjoint, ascending, at the height y.
  std::vector<Span> at(double y) const;

 private:
  std::vector<glm::dvec2> corners_;
};

}  // namespace vernier::measure
