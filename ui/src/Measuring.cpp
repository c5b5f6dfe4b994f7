// SPDX-License-Identifier: GPL-3.0-or-later
#include "Measuring.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vernier::ui {
namespace {

using measure::Space;
using measure::Spot;

constexpr int kEllipsePoints = 72;
constexpr double kHeadShare = 0.18;

// The sides of boxes: columns and rows of a frame, right and up of the picture.
struct Sides {
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0};
};
Sides sidesOf(const measure::Placement& on) {
  if (on.space == Space::Image || !on.axes) return {};
  const glm::dvec3 n = glm::normalize(on.axes->normal.v);
  const glm::dvec3 up = glm::normalize(on.axes->up.v - glm::dot(on.axes->up.v, n) * n);
  return {glm::cross(up, n), up};
}

std::vector<std::vector<Spot>> boxLines(const measure::Placement& on, const std::array<Spot, 2>& corners,
                                        bool ellipse) {
  const Sides s = sidesOf(on);
  const glm::dvec3 d = corners[1] - corners[0];
  const glm::dvec3 x = glm::dot(d, s.right) * s.right, y = glm::dot(d, s.up) * s.up;
  if (!ellipse) return {{corners[0], corners[0] + x, corners[0] + x + y, corners[0] + y, corners[0]}};
  std::vector<Spot> round;
  for (int n = 0; n <= kEllipsePoints; ++n) {
    const double t = 2 * std::numbers::pi * n / kEllipsePoints;
    round.push_back(corners[0] + 0.5 * (x + y) + 0.5 * (std::cos(t) * x + std::sin(t) * y));
  }
  return {round};
}

std::vector<Spot> closed(std::vector<Spot> points) {
  if (!points.empty()) points.push_back(points.front());
  return points;
}

std::vector<std::vector<Spot>> arrowLines(const measure::Placement& on, const measure::Arrow& a) {
  const Sides s = sidesOf(on);
  const glm::dvec3 back = kHeadShare * (a.tail - a.tip);
  const glm::dvec3 across = 0.5 * (glm::dot(back, s.right) * s.up - glm::dot(back, s.up) * s.right);
  return {{a.tail, a.tip}, {a.tip + back + across, a.tip, a.tip + back - across}};
}

}  // namespace

const std::vector<RulerFacts>& rulers() {
  static const std::vector<RulerFacts> all = {
      {Ruler::Length, "Length", "L", "from one end to the other", 2},
      {Ruler::Angle, "Angle", "A", "an end, the vertex, the other end", 3},
      {Ruler::Cobb, "Cobb angle", "Y", "one line, then the other: two drags or four clicks", 4},
      {Ruler::Bidirectional, "Diameters", "D", "the long axis, then the short one at right angles to it", 4},
      {Ruler::Ellipse, "Ellipse", "E", "two corners of its box", 2},
      {Ruler::Rectangle, "Rectangle", "B", "two corners", 2},
      {Ruler::Polygon, "Polygon", "O", "its corners; double click, Enter or the first one again closes it",
       0},
      {Ruler::Freehand, "By hand", "H", "press, draw around it, let go", 0},
      {Ruler::Probe, "Value", "V", "the value of a point", 1},
      {Ruler::Arrow, "Arrow", "N", "its tip, then its tail", 2},
      {Ruler::Text, "Text", "X", "a point, then the words, then Enter", 1}};
  return all;
}
const RulerFacts& factsOf(Ruler r) {
  return *std::find_if(rulers().begin(), rulers().end(), [&](const RulerFacts& f) { return f.ruler == r; });
}

measure::Shape shapeOf(Ruler r, const std::vector<Spot>& p) {
  const std::size_t points = factsOf(r).points;
  VERNIER_ASSERT(points > 0 ? p.size() == points : p.size() >= 3);
  switch (r) {
    case Ruler::Length:
      return measure::Length{{p[0], p[1]}};
    case Ruler::Angle:
      return measure::Angle{p[1], {p[0], p[2]}};
    case Ruler::Cobb:
      return measure::Cobb{{p[0], p[1]}, {p[2], p[3]}};
    case Ruler::Bidirectional:
      return measure::Bidirectional{{p[0], p[1]}, {p[2], p[3]}};
    case Ruler::Rectangle:
      return measure::RectangleRegion{{p[0], p[1]}};
    case Ruler::Ellipse:
      return measure::EllipseRegion{{p[0], p[1]}};
    case Ruler::Polygon:
      return measure::PolygonRegion{p};
    case Ruler::Freehand:
      return measure::FreehandRegion{p};
    case Ruler::Probe:
      return measure::Probe{p[0]};
    case Ruler::Arrow:
      return measure::Arrow{p[0], p[1], ""};
    case Ruler::Text:
      return measure::Text{p[0], ""};
  }
  return measure::Probe{};
}

std::optional<measure::Placement> placementOn(const Scene& scene, const SourceId& source,
                                              const Place& place) {
  measure::Placement on;
  on.source = source.name;
  if (const ImageLayer* image = imageOf(scene); image && place.image) {
    on.space = Space::Image;
    on.frame = image->index;
    on.screenPixel = 1 / std::max(std::abs(place.image->pxPerColumn), std::abs(place.image->pxPerRow));
    return on;
  }
  const SliceLayer* slice = sliceOf(scene);
  if (!slice || !place.inPatient) return std::nullopt;
  on.axes = measure::Placement::Axes{slice->plane.normal, slice->plane.up};
  if (slice->slab.thickness_mm > 0) on.shown = measure::Shown::Slab;
  on.screenPixel = place.unit_mm;
  return on;
}

Spot spotAt(const Place& place, Space space, glm::dvec2 px) {
  if (space == Space::Patient) return place.patientAt(px).p;
  const glm::dvec2 p = frameFromPicture(*place.image, px) + 0.5;
  return {p, 0};
}
glm::dvec2 pixelOf(const Place& place, Space space, const Spot& s) {
  if (space == Space::Patient) return place.pixelOf(PatientPoint(s));
  return pictureFromFrame(*place.image, glm::dvec2(s) - 0.5);
}

bool standsOn(const measure::Placement& on, const Spot& s, const Scene& scene, const SourceId& source,
              const Place& place) {
  const auto here = placementOn(scene, source, place);
  if (!here || here->space != on.space || here->source != on.source || here->frame != on.frame ||
      here->shown != on.shown || here->axes != on.axes)
    return false;
  return on.space == Space::Image || std::abs(place.distance_mm(PatientPoint(s))) <= 1e-6 * place.unit_mm;
}

bool shownOn(const Drawn& d, const Scene& scene, const SourceId& source, const Place& place,
             const SourceFacts& here, const SourceFacts* there) {
  if (d.document != source.document && d.what.on.space == Space::Image) return false;
  if (d.what.on.space == Space::Image) {
    const ImageLayer* image = imageOf(scene);
    return image && place.image && d.what.on.source == source.name && d.what.on.frame == image->index;
  }
  if (!place.inPatient || !there || there->linkKey != here.linkKey) return false;
  if (imageOf(scene)) return false;  // a stored frame is measured in its own pixels
  double half = 0.5 * place.unit_mm;
  if (here.grid) {
    const glm::dvec3 s = here.grid->spacing_mm();
    half = 0.5 * std::min({s.x, s.y, s.z});
  }
  const std::vector<Spot> points = measure::handlesOf(d.what.shape);
  return !points.empty() && std::all_of(points.begin(), points.end(), [&](const Spot& p) {
    return std::abs(place.distance_mm(PatientPoint(p))) <= half;
  });
}

std::vector<std::vector<Spot>> linesOf(const measure::Measurement& m) {
  const measure::Shape& s = m.shape;
  if (const auto* x = std::get_if<measure::Length>(&s)) return {{x->ends[0], x->ends[1]}};
  if (const auto* x = std::get_if<measure::Bidirectional>(&s))
    return {{x->longAxis[0], x->longAxis[1]}, {x->shortAxis[0], x->shortAxis[1]}};
  if (const auto* x = std::get_if<measure::Angle>(&s)) return {{x->arms[0], x->vertex, x->arms[1]}};
  if (const auto* x = std::get_if<measure::Cobb>(&s))
    return {{x->first[0], x->first[1]}, {x->second[0], x->second[1]}};
  if (const auto* x = std::get_if<measure::RectangleRegion>(&s)) return boxLines(m.on, x->corners, false);
  if (const auto* x = std::get_if<measure::EllipseRegion>(&s)) return boxLines(m.on, x->corners, true);
  if (const auto* x = std::get_if<measure::PolygonRegion>(&s)) return {closed(x->corners)};
  if (const auto* x = std::get_if<measure::FreehandRegion>(&s)) return {closed(x->outline)};
  if (const auto* x = std::get_if<measure::Arrow>(&s)) return arrowLines(m.on, *x);
  return {};
}

Spot labelAt(const measure::Measurement& m) {
  const std::vector<Spot> points = measure::handlesOf(m.shape);
  if (const auto* x = std::get_if<measure::Angle>(&m.shape)) return x->vertex;
  return points.empty() ? Spot(0) : points.back();
}

}  // namespace vernier::ui
