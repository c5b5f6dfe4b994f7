// SPDX-License-Identifier: GPL-3.0-or-later
// Regions: area with its +/- from the corners, and the values inside.
#include <algorithm>

#include "Region.h"
#include "vernier/measure/Outline.h"

namespace vernier::measure {
namespace {

constexpr double kPi = 3.14159265358979323846;

Flat planeOf(const Work& w, const Spot& through) {
  if (!w.axes) refuse("A region needs the plane of its picture: axes with a normal and an up.");
  Flat f;
  f.origin = w.point(through);
  f.up = w.axes->up.v;
  f.right = screenRight(*w.axes);
  return f;
}

std::vector<Spot> outlineOf(const Work& w, bool& ellipse) {
  ellipse = false;
  if (const auto* s = std::get_if<PolygonRegion>(&w.what.shape)) return s->corners;
  if (const auto* s = std::get_if<FreehandRegion>(&w.what.shape)) return s->outline;
  ellipse = std::holds_alternative<EllipseRegion>(w.what.shape);
  return {};
}

// Two corners of a box with sides along the plane's axes, as four.
void boxCorners(Flat& f, glm::dvec2 a, glm::dvec2 b) {
  if (a.x == b.x || a.y == b.y) refuse("The region has no width or no height; draw it again.");
  f.outline = {a, {b.x, a.y}, b, {a.x, b.y}};
}

Flat flatOf(Work& w) {
  bool ellipse = false;
  const std::vector<Spot> points = outlineOf(w, ellipse);
  const auto two = [&](const std::array<Spot, 2>& c) {
    Flat f = planeOf(w, c[0]);
    f.ellipse = ellipse;
    boxCorners(f, f.toFlat(w.point(c[0])), f.toFlat(w.point(c[1])));
    return f;
  };
  if (const auto* s = std::get_if<RectangleRegion>(&w.what.shape)) return two(s->corners);
  if (const auto* s = std::get_if<EllipseRegion>(&w.what.shape)) return two(s->corners);
  if (points.size() < 3) refuse("A region needs at least three corners; two enclose nothing.");
  if (points.size() > kMostOutlinePoints)
    refuse("The outline has " + std::to_string(points.size()) + " points, at most " +
           std::to_string(kMostOutlinePoints) + " are measured.");
  Flat f = planeOf(w, points[0]);
  for (const Spot& p : points) f.outline.push_back(f.toFlat(w.point(p)));
  return f;
}

// All points lie in the plane, to a thousandth of the smallest spacing.
void checkFlat(const Work& w, const Flat& f) {
  if (!w.volume) return;
  const glm::dvec3 s = w.volume->grid().spacing_mm();
  const double limit = 1e-3 * std::min({s.x, s.y, s.z});
  const glm::dvec3 normal = glm::cross(f.right, f.up);
  for (const Spot& p : handlesOf(w.what.shape))
    if (std::abs(glm::dot(w.point(p) - f.origin, normal)) > limit)
      refuse("The region's points do not lie in one plane of its picture.");
}

// Sum of g C g over the corners. Shoelace: the gradient at a corner is half the chord between its neighbours,
// turned by a right angle. An outline that crosses itself: no more than the half lengths of both edges, in
// the worst direction.
double areaVariance(const Work& w, const Flat& f, bool crosses) {
  const auto at = [&](glm::dvec2 g) { return w.quadratic(g.x * f.right + g.y * f.up); };
  const std::size_t n = f.outline.size();
  double sum = 0;
  if (f.ellipse || n == 4) {
    const bool box = f.ellipse || std::holds_alternative<RectangleRegion>(w.what.shape);
    if (box) {  // two corners make width and height
      const glm::dvec2 d = f.outline[2] - f.outline[0], g{d.y, d.x};
      return 2 * at(g) * (f.ellipse ? kPi * kPi / 16 : 1);
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 before = f.outline[(i + n - 1) % n], here = f.outline[i], after = f.outline[(i + 1) % n];
    if (crosses) {
      const double g = 0.5 * (glm::length(here - before) + glm::length(after - here));
      sum += g * g * w.worstVariance();
    } else {
      sum += at(0.5 * glm::dvec2(after.y - before.y, before.x - after.x));
    }
  }
  return sum;
}

void addArea(Work& w, const Flat& f) {
  const bool crosses = !f.ellipse && crossesItself(f.outline);
  const glm::dvec2 d = f.outline[2] - f.outline[0];
  const double area = f.ellipse ? kPi / 4 * std::abs(d.x * d.y) : areaOf(f.outline);
  const double around = lengthOf(f.outline);
  if (!(area > 1e-12 * around * around)) refuse("The outline encloses nothing; draw it again.");
  if (crosses) w.note("the outline crosses itself: even-odd");
  w.add(w.name("area"), area, w.unit + "2", w.expanded(areaVariance(w, f, crosses)));
}

void addValues(Work& w, const Flat& f) {
  if (w.projected()) {
    w.note("no statistics of values on a projection");
    return;
  }
  if (w.image ? w.image->isColour() : w.volume->isColour()) {
    w.note("colours have no values to be measured");
    return;
  }
  Inside in = valuesInside(w, f);
  const std::string unit = w.image ? w.image->info().unit : w.volume->info().unit;
  Statistics s = statisticsOf(in.raster.values, in.step);
  s.noData = in.noData;
  if (s.n < 1)
    refuse(in.noData > 0
               ? "The region holds nothing but padding or missing slices; draw it where there are values."
               : "No pixel has its centre inside the region; draw it larger.");
  s.effective = effectiveCount(in.raster, s.mean, s.n);
  if (in.interpolated) {
    w.note("interpolated");
    w.note("SD lower than pixel SD");
  }
  if (s.noData > 0) w.note("padding or missing slices are left out");
  const auto u = s.sd ? std::optional(2 * *s.sd / std::sqrt(s.effective)) : std::nullopt;
  w.add("mean", s.mean, unit, u);
  w.add("n", static_cast<double>(s.n), "1", std::nullopt);
  w.out.values = std::move(s);
}

}  // namespace

void measureRegion(Work& w) {
  Flat f;
  if (const auto* s = std::get_if<ThresholdRegion>(&w.what.shape)) {
    f = thresholdRegion(w, *s);
  } else {
    f = flatOf(w);
    checkFlat(w, f);
  }
  addArea(w, f);
  addValues(w, f);
  noteGaps(w, handlesOf(w.what.shape));
}

}  // namespace vernier::measure
