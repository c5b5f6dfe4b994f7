// SPDX-License-Identifier: GPL-3.0-or-later
#include "CurvedReference.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "Overhauser.h"

namespace vernier::quality {
namespace {

constexpr double kCoincident_mm = 1e-6, kSlack_mm = 1e-6;
constexpr double kTurnPerStep_rad = 0.02;

bool finite(glm::dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
Error degenerate(const char* sentence) { return makeError(ErrorCode::PathDegenerate, sentence); }

// A curve's piece, u in [0, 1].
struct CurvePiece {
  std::array<Poly, 3> p, d1, d2;
  static glm::dvec3 at(const std::array<Poly, 3>& q, double u) { return {q[0](u), q[1](u), q[2](u)}; }
  glm::dvec3 point(double u) const { return at(p, u); }
  glm::dvec3 slope(double u) const { return at(d1, u); }
  glm::dvec3 bend(double u) const { return at(d2, u); }
};

std::vector<CurvePiece> piecesThrough(const std::vector<glm::dvec3>& points) {
  std::vector<CurvePiece> pieces;
  const auto apart = [&](std::size_t n) { return std::sqrt(glm::length(points[n + 1] - points[n])); };
  const std::size_t n = points.size();
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double before = i > 0 ? apart(i - 1) / apart(i) : 0,
                 after = i + 2 < n ? apart(i + 1) / apart(i) : 0;
    const std::array<Poly, 4> w = overhauser(before, after, line(0, 1));
    CurvePiece piece;
    for (int a = 0; a < 3; ++a) {
      Poly sum{{0}, 0};
      for (std::size_t m = 0; m < 4; ++m) {
        if (i + m < 1 || i + m > n) continue;
        sum = sum + scaled(points[i + m - 1][a], w[m]);
      }
      const auto at = static_cast<std::size_t>(a);
      piece.p[at] = sum;
      piece.d1[at] = derivative(sum);
      piece.d2[at] = derivative(piece.d1[at]);
    }
    pieces.push_back(piece);
  }
  return pieces;
}

// Arc length and up vector, carried along the path.
struct Carried {
  double s = 0;
  glm::dvec3 up{0};
};

// `seenAlong` zero, or the direction along which lengths do not count and up stays as it is.
struct Carrier {
  const CurvePiece& piece;
  glm::dvec3 seenAlong;
  glm::dvec3 flat(glm::dvec3 v) const { return v - glm::dot(v, seenAlong) * seenAlong; }
  double speed(double u) const { return glm::length(flat(piece.slope(u))); }
  glm::dvec3 tangent(double u) const { return glm::normalize(flat(piece.slope(u))); }

  // d/du of both: ds = |C'|; up' = -(up . T') T, so that up stays across and does not turn about T.
  Carried rate(double u, glm::dvec3 up) const {
    const double v = speed(u);
    if (seenAlong != glm::dvec3(0)) return {v, glm::dvec3(0)};
    const glm::dvec3 t = tangent(u), bend = piece.bend(u);
    const glm::dvec3 turning = (bend - glm::dot(bend, t) * t) / v;
    return {v, -glm::dot(up, turning) * t};
  }

  // One step of Runge-Kutta of fourth order from u by h.
  Carried step(const Carried& from, double u, double h) const {
    const Carried a = rate(u, from.up), b = rate(u + 0.5 * h, from.up + 0.5 * h * a.up);
    const Carried c = rate(u + 0.5 * h, from.up + 0.5 * h * b.up), d = rate(u + h, from.up + h * c.up);
    return {from.s + h / 6 * (a.s + 2 * b.s + 2 * c.s + d.s),
            from.up + h / 6 * (a.up + 2.0 * b.up + 2.0 * c.up + d.up)};
  }

  int stepsFor() const {
    double turn_rad = 0;
    glm::dvec3 last = tangent(0);
    for (int n = 1; n <= 16; ++n) {
      const glm::dvec3 next = tangent(n / 16.0);
      turn_rad += std::atan2(glm::length(glm::cross(last, next)), glm::dot(last, next));
      last = next;
    }
    return 8 + static_cast<int>(std::min(4096.0, turn_rad / kTurnPerStep_rad));
  }
};

// Knots along the whole path.
struct Knot {
  std::size_t piece = 0;
  double u = 0;  // where the step that ends here began: the knot before, or 0
  double step = 0;
  Carried begin;  // there
  double s = 0;   // at its end
};

std::vector<Knot> knotsOf(const std::vector<CurvePiece>& pieces, glm::dvec3 up, glm::dvec3 seenAlong) {
  std::vector<Knot> knots;
  Carried at{0, up};
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Carrier carrier{pieces[i], seenAlong};
    const int steps = carrier.stepsFor();
    for (int n = 0; n < steps; ++n) {
      const double h = 1.0 / steps, u = n * h;
      const Carried next = carrier.step(at, u, h);
      knots.push_back({i, u, h, at, next.s});
      at = next;
    }
  }
  return knots;
}

glm::dvec3 ownUp(const CurvedLayer& layer, const std::vector<glm::dvec3>& points) {
  glm::dvec3 least(1e300), greatest(-1e300);
  if (layer.form == CurvedForm::Straightened) {
    const glm::dvec3 first = glm::abs(glm::normalize(points[1] - points[0]));
    least = glm::dvec3(0), greatest = first;
  } else {
    for (const glm::dvec3& p : points) least = glm::min(least, p), greatest = glm::max(greatest, p);
  }
  const glm::dvec3 size = greatest - least;
  const double same = 1e-6 * (size.x + size.y + size.z);
  if (size.z <= size.x + same && size.z <= size.y + same) return {0, 0, 1};
  return size.y <= size.x + same ? glm::dvec3(0, -1, 0) : glm::dvec3(1, 0, 0);
}

// Least and greatest height of the curve along a direction.
LocalRange heightsOf(const std::vector<CurvePiece>& pieces, glm::dvec3 up) {
  LocalRange range;
  for (const CurvePiece& piece : pieces) {
    const Poly height = scaled(up.x, piece.p[0]) + scaled(up.y, piece.p[1]) + scaled(up.z, piece.p[2]);
    range.add(height(0));
    range.add(height(1));
    for (double u : rootsInside(derivative(height))) range.add(height(u));
  }
  return range;
}

}  // namespace

Result<CurvedReference> CurvedReference::make(const Scene& scene, const CurvedLayer& layer, const View& view,
                                              const Sources& sources) {
  auto reading = VolumeReading::make(layer, sources);
  if (!reading) return reading.error();
  CurvedReference r(std::move(*reading), layer);
  if (auto placed = r.place(scene.camera, view); !placed) return placed.error();
  return r;
}

Result<void> CurvedReference::place(const Camera& camera, const View& view) {
  std::vector<glm::dvec3> points;
  for (const PatientPoint& p : layer_.path) {
    if (!finite(p.p)) return degenerate("A point of the path is not finite.");
    if (points.empty() || glm::length(p.p - points.back()) >= kCoincident_mm) points.push_back(p.p);
  }
  if (points.size() < 2) return degenerate("The path has less than two points that are apart.");
  const glm::dvec3 wanted = layer_.up ? layer_.up->v : ownUp(layer_, points);
  if (!finite(wanted) || !(glm::length(wanted) > 0)) return degenerate("The path's up vector has no length.");
  const bool stretched = layer_.form == CurvedForm::Stretched;
  const std::vector<CurvePiece> pieces = piecesThrough(points);
  const glm::dvec3 fixedUp = glm::normalize(wanted);
  const glm::dvec3 first = glm::normalize(pieces[0].slope(0));
  const glm::dvec3 up = stretched ? fixedUp : glm::normalize(fixedUp - glm::dot(fixedUp, first) * first);
  if (!finite(up)) return degenerate("The path's up vector runs along its beginning.");
  const glm::dvec3 seenAlong = stretched ? fixedUp : glm::dvec3(0);
  const std::vector<Knot> knots = knotsOf(pieces, up, seenAlong);
  const double length_mm = knots.back().s;
  const LocalRange heights = stretched ? heightsOf(pieces, fixedUp) : LocalRange{0, 0};
  const double across_mm = layer_.width_mm + heights.max - heights.min;

  const double w = view.width_px, h = view.height_px;
  const double mm =
      (camera.height_mm ? *camera.height_mm / h : std::max(length_mm / w, across_mm / h)) / camera.zoom;
  if (!(mm > 0) || !std::isfinite(mm) || !std::isfinite(length_mm))
    return makeError(ErrorCode::SceneInvalid, "The picture of the path has no finite scale.");
  const double middleRow = h / 2 + camera.pan_mm.y / mm, half_px = (0.5 * across_mm + kSlack_mm) / mm;
  for (int x = -1; x <= view.width_px; ++x) {
    columns_.emplace_back();
    const double s = 0.5 * length_mm + camera.pan_mm.x + (x + 0.5 - w / 2) * mm;
    if (s < -kSlack_mm || s > length_mm + kSlack_mm) continue;
    const auto knot = std::lower_bound(knots.begin(), knots.end() - 1, s,
                                       [](const Knot& k, double value) { return k.s < value; });
    const Carrier carrier{pieces[knot->piece], seenAlong};
    double low = 0, high = knot->step;  // bisection: arc length grows all along the step
    for (int n = 0; n < 60; ++n) {
      const double mid = 0.5 * (low + high);
      (carrier.step(knot->begin, knot->u, mid).s < s ? low : high) = mid;
    }
    const Carried at = carrier.step(knot->begin, knot->u, high);
    const double u = knot->u + high;
    glm::dvec3 centre = pieces[knot->piece].point(u);
    const glm::dvec3 tangent = carrier.tangent(u);
    if (stretched) centre = carrier.flat(centre) + 0.5 * (heights.min + heights.max) * fixedUp;
    const glm::dvec3 upHere =
        stretched ? fixedUp : glm::normalize(at.up - glm::dot(at.up, tangent) * tangent);
    Column column;
    column.down = -mm * upHere;
    column.top = centre - middleRow * column.down;
    column.normal = glm::cross(tangent, upHere);
    column.firstRow = middleRow - half_px;
    column.lastRow = middleRow + half_px;
    columns_.back() = column;
  }
  return {};
}

std::optional<CurvedReference::Column> CurvedReference::columnAt(int x) const {
  if (x < -1 || x + 1 >= static_cast<int>(columns_.size())) return std::nullopt;
  return columns_[static_cast<std::size_t>(x + 1)];
}

std::optional<glm::dvec3> CurvedReference::pointAt(glm::dvec2 pixel, glm::dvec3& normal) const {
  const auto column = columnAt(static_cast<int>(std::floor(pixel.x)));
  if (!column || pixel.y < column->firstRow || pixel.y > column->lastRow) return std::nullopt;
  normal = column->normal;
  return column->top + pixel.y * column->down;
}

std::optional<SliceValue> CurvedReference::value(glm::dvec2 pixel, int samples) const {
  glm::dvec3 normal;
  const auto p = pointAt(pixel, normal);
  return p ? reading_.value(*p, normal, samples) : std::nullopt;
}

bool CurvedReference::covers(glm::dvec2 pixel, int samples) const {
  glm::dvec3 normal;
  const auto p = pointAt(pixel, normal);
  return p && reading_.covers(*p, normal, samples);
}

}  // namespace vernier::quality
