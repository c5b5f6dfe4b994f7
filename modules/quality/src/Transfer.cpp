// SPDX-License-Identifier: GPL-3.0-or-later
#include "Transfer.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier::quality {
namespace {

double of(const OpacityPoint& p) { return p.opacity; }
glm::dvec3 of(const ColourPoint& p) { return p.colour; }

// Just above (or at) a value, and just below it.
template <class Point>
auto above(const std::vector<Point>& points, double value) {
  const auto next = std::upper_bound(points.begin(), points.end(), value,
                                     [](double v, const Point& p) { return v < p.value; });
  if (next == points.begin()) return of(points.front());
  if (next == points.end()) return of(points.back());
  const Point& before = *(next - 1);
  return of(before) + (value - before.value) / (next->value - before.value) * (of(*next) - of(before));
}
template <class Point>
auto below(const std::vector<Point>& points, double value) {
  const auto next = std::lower_bound(points.begin(), points.end(), value,
                                     [](const Point& p, double v) { return p.value < v; });
  if (next == points.end()) return of(points.back());
  if (next == points.begin() || next->value == value) return of(*next);
  const Point& before = *(next - 1);
  return of(before) + (value - before.value) / (next->value - before.value) * (of(*next) - of(before));
}

}  // namespace

Result<Transfer> Transfer::make(const TransferFunction& f) {
  if (auto r = checkTransferFunction(f); !r) return r.error();
  std::vector<double> knots;
  for (const ColourPoint& p : f.colours) knots.push_back(p.value);
  for (const OpacityPoint& p : f.opacities) knots.push_back(p.value);
  std::sort(knots.begin(), knots.end());
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  Transfer t;
  t.length_mm_ = f.opacityLength_mm;
  Interval first;
  first.lo = -std::numeric_limits<double>::infinity();
  first.opacity = f.opacities.front().opacity, first.colour = f.colours.front().colour;
  first.shows = first.opacity > 0, first.opaque = first.opacity >= 1;
  t.intervals_.push_back(first);
  for (std::size_t n = 0; n < knots.size(); ++n) {
    Interval i;
    i.lo = knots[n];
    i.opacity = above(f.opacities, i.lo), i.colour = above(f.colours, i.lo);
    double end = i.opacity;
    if (n + 1 < knots.size()) {
      const double width = knots[n + 1] - knots[n];
      end = below(f.opacities, knots[n + 1]);
      i.opacitySlope = (end - i.opacity) / width;
      i.colourSlope = (below(f.colours, knots[n + 1]) - i.colour) / width;
    }
    i.shows = i.opacity > 0 || end > 0, i.opaque = i.opacity >= 1 && end >= 1;
    const Interval& before = t.intervals_.back();
    const bool jump = below(f.opacities, i.lo) != i.opacity || below(f.colours, i.lo) != i.colour;
    i.steps = before.steps + (jump ? 1 : 0);
    i.showing = before.showing + (before.shows ? 1 : 0);
    t.intervals_.push_back(i);
  }
  return t;
}

std::size_t Transfer::at(double value) const {
  const auto next = std::upper_bound(intervals_.begin() + 1, intervals_.end(), value,
                                     [](double v, const Interval& i) { return v < i.lo; });
  return static_cast<std::size_t>(next - intervals_.begin()) - 1;
}

double Transfer::opacity(std::size_t interval, double value) const {
  const Interval& i = intervals_[interval];
  return interval == 0 ? i.opacity : std::clamp(i.opacity + (value - i.lo) * i.opacitySlope, 0.0, 1.0);
}

glm::dvec3 Transfer::colour(std::size_t interval, double value) const {
  const Interval& i = intervals_[interval];
  return interval == 0 ? i.colour : glm::clamp(i.colour + (value - i.lo) * i.colourSlope, 0.0, 1.0);
}

double Transfer::extinction_perMm(std::size_t interval, double value) const {
  constexpr double most = 1 - 0x1p-53;
  return -std::log1p(-std::min(opacity(interval, value), most)) / length_mm_;
}

bool Transfer::showsIn(double least, double greatest) const {
  if (!(least <= greatest)) return false;
  const std::size_t from = at(least);
  if (opacity(from, least) > 0) return true;
  std::size_t to = at(greatest);
  if (to > 0 && greatest == lo(to)) {  // only the end of the last interval counts
    if (opacity(to, greatest) > 0) return true;
    if (least == greatest) return false;
    --to;
  } else if (least == greatest) {
    return false;
  }
  return to >= from && intervals_[to].showing + (intervals_[to].shows ? 1 : 0) > intervals_[from].showing;
}

// Newton's steps, and halves where they lead astray: the field is monotone in between.
double Transfer::place(const Piece& p, double value, double from, double to) {
  double lo = from, hi = to;
  const double atLo = p(lo) - value;
  if (atLo == 0) return from;
  if ((p(hi) - value < 0) == (atLo < 0)) return to;  // by rounding only
  const Poly dn = derivative(p.numerator), dw = p.plain ? Poly{} : derivative(p.weight);
  double u = 0.5 * (lo + hi), last = hi - lo;
  for (int n = 0; n < 100 && hi - lo > 1e-15; ++n) {
    const double off = p(u) - value;
    if (off == 0) return u;
    ((off < 0) == (atLo < 0) ? lo : hi) = u;
    const double slope = p.plain ? dn(u) : (dn(u) - p(u) * dw(u)) / p.weight(u);
    double next = slope != 0 ? u - off / slope : lo;
    const bool astray = !(next > lo && next < hi) || std::abs(next - u) > 0.5 * last;
    if (astray) next = 0.5 * (lo + hi);
    last = std::abs(next - u);
    u = next;
    if (last < 1e-16) break;
  }
  return u;
}

}  // namespace vernier::quality
