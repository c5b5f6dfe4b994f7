// SPDX-License-Identifier: GPL-3.0-or-later
// The reference's own reading of a transfer function (volume/TransferFunction.h says what it means):
// intervals of values between neighbouring points of either list, on each of which colour and opacity are
// straight lines. The last of two points of one value holds at it, so interval n holds at values in [lo(n),
// lo(n + 1)).
#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "Field.h"
#include "vernier/volume/TransferFunction.h"

namespace vernier::quality {

class Transfer {
 public:
  // SceneInvalid: what checkTransferFunction says.
  static Result<Transfer> make(const TransferFunction&);

  std::size_t at(double value) const;  // the interval that holds at a value
  // The one that holds just beside it, on the side of another.
  std::size_t beside(double value, double other) const {
    const std::size_t n = at(value);
    return other < value && n > 0 && value == lo(n) ? n - 1 : n;
  }
  std::size_t size() const { return intervals_.size(); }
  double lo(std::size_t interval) const { return intervals_[interval].lo; }
  bool shows(std::size_t interval) const { return intervals_[interval].shows; }    // not clear as a whole
  bool opaque(std::size_t interval) const { return intervals_[interval].opaque; }  // 1 as a whole
  double opacity(std::size_t interval, double value) const;
  glm::dvec3 colour(std::size_t interval, double value) const;
  // Per mm; an opacity of 1 counts as the greatest below it.
  double extinction_perMm(std::size_t interval, double value) const;
  double opacityLength_mm() const { return length_mm_; }
  // Whether some value in [least, greatest] is not clear.
  bool showsIn(double least, double greatest) const;

  // Places where colour or opacity jumps: how many there are, and how many a value has reached.
  std::size_t steps() const { return intervals_.back().steps; }
  std::size_t stepsUpTo(std::size_t interval) const { return intervals_[interval].steps; }
  bool isStep(std::size_t interval) const {  // at its lower end
    return interval > 0 && intervals_[interval].steps != intervals_[interval - 1].steps;
  }

  // Of a field that rises or falls from `from` to `to`: fn(interval, u0, u1) for each stretch that shows, in
  // order, and knot(interval, next, u) for each passage from one interval to the next where one of the two
  // shows; either ends the walk by answering false, which is then the answer.
  template <class Fn, class Knot>
  bool along(const Piece& p, double from, double to, Fn&& fn, Knot&& knot) const {
    const double a = p(from), b = p(to);
    std::size_t n = beside(a, b);
    const std::size_t last = beside(b, a);
    double u = from;
    while (n != last) {
      const std::size_t next = last > n ? n + 1 : n - 1;
      if (shows(n) || shows(next)) {
        const double end = place(p, lo(std::max(n, next)), u, to);
        if (shows(n) && end > u && !fn(n, u, end)) return false;
        u = end;
        if (!knot(n, next, u)) return false;
      }
      n = next;
    }
    return !shows(n) || !(to > u) || fn(n, u, to);
  }

 private:
  struct Interval {
    double lo = 0;
    double opacity = 0, opacitySlope = 0;  // at lo, per unit of value; the first interval: everywhere
    glm::dvec3 colour{0}, colourSlope{0};
    bool shows = false, opaque = false;
    std::size_t steps = 0;    // jumps up to its lower end
    std::size_t showing = 0;  // intervals before it that show
  };
  static double place(const Piece&, double value, double from, double to);
  std::vector<Interval> intervals_;
  double length_mm_ = 1;
};

}  // namespace vernier::quality
