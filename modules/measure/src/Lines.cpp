// SPDX-License-Identifier: GPL-3.0-or-later
// Lengths and angles. Gradients: of |b - a| the unit vector along it; of the angle between two arms a unit
// vector at right angles to each arm, in their plane, over the arm's length.
#include "Work.h"

namespace vernier::measure {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

struct Line {
  double length, variance;
};
Line lineOf(const Work& w, const std::array<Spot, 2>& ends) {
  const glm::dvec3 d = w.point(ends[1]) - w.point(ends[0]);
  const double length = glm::length(d);
  return {length, 2 * (length > 0 ? w.quadratic(d / length) : w.worstVariance())};
}

void length(Work& w, const std::array<Spot, 2>& ends, const char* name) {
  const Line l = lineOf(w, ends);
  w.add(w.name(name), l.length, w.unit, w.expanded(l.variance));
  noteGaps(w, ends);
}

void checkArm(glm::dvec3 arm) {
  if (!(glm::length(arm) > 0)) refuse("An arm of the angle has no length; move one of its ends.");
}

// Radians, from 0 to pi, exact near both: never the acos of a rounded cosine.
double between(glm::dvec3 a, glm::dvec3 b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Towards the other direction, at right angles to `arm`; nullopt where they lie on one line.
std::optional<glm::dvec3> towards(glm::dvec3 arm, glm::dvec3 other) {
  const glm::dvec3 u = glm::normalize(arm), across = other - glm::dot(other, u) * u;
  const double size = glm::length(across);
  if (!(size > 1e-12 * glm::length(other))) return std::nullopt;
  return across / size;
}

void angle(Work& w, const Angle& s) {
  const glm::dvec3 v = w.point(s.vertex), a = w.point(s.arms[0]) - v, b = w.point(s.arms[1]) - v;
  checkArm(a);
  checkArm(b);
  const auto p = towards(a, b), q = towards(b, a);
  if (!p || !q)
    refuse("The arms of the angle lie on one line, so that it has no plane; move one of the points.");
  const glm::dvec3 ga = -*p / glm::length(a), gb = -*q / glm::length(b);
  const double variance = w.quadratic(ga) + w.quadratic(gb) + w.quadratic(ga + gb);
  w.add(w.name("angle"), between(a, b) * kDegrees, "deg", w.expanded(variance * kDegrees * kDegrees));
  const std::array spots{s.arms[0], s.vertex, s.arms[1]};
  noteGaps(w, spots);
}

void cobb(Work& w, const Cobb& s) {
  const glm::dvec3 a = w.point(s.first[1]) - w.point(s.first[0]),
                   b = w.point(s.second[1]) - w.point(s.second[0]);
  checkArm(a);
  checkArm(b);
  const double full = between(a, b), folded = std::min(full, 3.14159265358979323846 - full);
  const auto p = towards(a, b), q = towards(b, a);
  // Parallel lines turn against each other in any direction: the worst one counts.
  const auto turn = [&](const std::optional<glm::dvec3>& across, glm::dvec3 arm) {
    const double l = glm::length(arm);
    return 2 * (across ? w.quadratic(*across) : w.worstVariance()) / (l * l);
  };
  w.add(w.name("angle"), folded * kDegrees, "deg",
        w.expanded((turn(p, a) + turn(q, b)) * kDegrees * kDegrees));
  const std::array spots{s.first[0], s.first[1], s.second[0], s.second[1]};
  noteGaps(w, spots);
}

}  // namespace

void measureLines(Work& w) {
  if (w.unit == "px" && w.out.origin == Origin::Pixels &&
      (std::holds_alternative<Angle>(w.what.shape) || std::holds_alternative<Cobb>(w.what.shape)))
    w.note("pixels are taken as square");
  if (const auto* s = std::get_if<Length>(&w.what.shape)) length(w, s->ends, "length");
  if (const auto* s = std::get_if<Bidirectional>(&w.what.shape)) {
    length(w, s->longAxis, "long axis");
    length(w, s->shortAxis, "short axis");
  }
  if (const auto* s = std::get_if<Angle>(&w.what.shape)) angle(w, *s);
  if (const auto* s = std::get_if<Cobb>(&w.what.shape)) cobb(w, *s);
}

}  // namespace vernier::measure
