// SPDX-License-Identifier: GPL-3.0-or-later
#include "Brightness.h"

#include <algorithm>
#include <cmath>

#include "Gauss.h"
#include "Grey.h"

namespace vernier::quality {
namespace {

constexpr double kHair = 1e-7, kBeside = 1e-12;

Poly constant(double x) { return Poly{{x}, 0}; }
Poly weightOf(const Piece& p) { return p.plain ? constant(1) : p.weight; }

// Values at which the grey of a window of straight lines starts and ends to rise (PS3.3 C.11.2.1.2).
struct Knots {
  double lo = 0, hi = 1;
};
Knots knotsOf(const VoiWindow& w) {
  if (w.function == VoiFunction::LinearExact || w.width < 1)
    return {w.center - w.width / 2, w.center + w.width / 2};
  const double middle = w.center - 0.5, half = (w.width - 1) / 2;
  return {middle - half, middle + half};
}

// Roots of field - level inside the piece.
std::vector<double> placesOf(const Piece& p, double level) {
  return rootsInside(p.numerator - constant(level) * weightOf(p));
}

struct Search {
  const Piece& piece;
  const VoiWindow& window;
  const Cue& cue;
  double best = 0;

  double end(double u) const { return piece.plain ? u : std::clamp(u, kHair, 1 - kHair); }
  void look(double u) {
    u = end(u);
    best = std::max(best, windowGrey(window, piece(u)) * cue(u));
  }
  // The field is monotone between a and b, and the cue does not rise.
  void bracket(double a, double b) {
    const double bound = std::max(windowGrey(window, piece(a)), windowGrey(window, piece(b))) * cue(a);
    if (bound <= best * (1 + 1e-9) || b - a < 1e-13) return;
    const double mid = 0.5 * (a + b);
    look(mid);
    // The half that looks brighter first: the other then has more to beat.
    const bool first = windowGrey(window, piece(a)) * cue(a) > windowGrey(window, piece(b)) * cue(b);
    first ? bracket(a, mid) : bracket(mid, b);
    first ? bracket(mid, b) : bracket(a, mid);
  }
};

}  // namespace

double brightest(const Piece& piece, const VoiWindow& window, const Cue& cue, double atLeast) {
  const LocalRange range = piece.extremes();
  const double most = windowGrey(window, range.max);
  if (most * cue(0) <= atLeast) return atLeast;
  Search search{piece, window, cue, atLeast};
  if (cue(0) == cue(1)) return std::max(atLeast, most * cue(0));
  search.look(0);
  search.look(1);
  if (window.function == VoiFunction::Sigmoid) {
    const std::vector<double> stops = monotoneStops(piece);
    for (double u : stops) search.look(u);
    for (std::size_t n = 0; n + 1 < stops.size(); ++n) search.bracket(stops[n], stops[n + 1]);
    return search.best;
  }
  const auto [lo, hi] = knotsOf(window);
  std::vector<double> knots = placesOf(piece, hi);
  if (hi == lo) knots.insert(knots.end(), {0, 1});
  // A little beside a knot too: a window without width jumps there.
  for (double u : knots)
    for (double beside : {u - kBeside, u, u + kBeside}) search.look(std::clamp(beside, 0.0, 1.0));
  const Poly w = weightOf(piece), above = (piece.numerator - constant(lo) * w) * cue.numerator,
             below = w * cue.denominator;
  for (double u : rootsInside(derivative(above) * below - above * derivative(below))) search.look(u);
  return search.best;
}

double meanGrey(const Piece& piece, const VoiWindow& window) {
  const bool sigmoid = window.function == VoiFunction::Sigmoid;
  std::vector<double> stops{0};
  const auto cutAt = [&](double level) {
    for (double u : placesOf(piece, level)) stops.push_back(u);
  };
  const Knots knots = knotsOf(window);
  if (sigmoid) {
    for (double widths : {-4.0, -1.0, -0.25, 0.0, 0.25, 1.0, 4.0})
      cutAt(window.center + widths * window.width);
  } else {
    cutAt(knots.lo);
    if (knots.hi > knots.lo) cutAt(knots.hi);
  }
  stops.push_back(1);
  std::sort(stops.begin(), stops.end());
  double sum = 0;
  for (std::size_t n = 0; n + 1 < stops.size(); ++n) {
    const double a = stops[n], b = stops[n + 1];
    const auto grey = [&](double u) { return windowGrey(window, piece(u)); };
    if (sigmoid) {
      sum += integral(grey, a, b);
      continue;
    }
    const double value = piece(0.5 * (a + b));
    if (value <= knots.lo) continue;
    if (value >= knots.hi) {
      sum += b - a;
      continue;
    }
    const auto ramp = [&](double u) { return (piece(u) - knots.lo) / (knots.hi - knots.lo); };
    sum += piece.plain ? gauss8(ramp, a, b) : integral(ramp, a, b);
  }
  return sum;
}

std::vector<double> monotoneStops(const Piece& p) {
  const double inset = p.plain ? 0 : kHair;
  std::vector<double> stops{inset};
  const Poly slope = p.plain ? derivative(p.numerator)
                             : derivative(p.numerator) * p.weight - p.numerator * derivative(p.weight);
  for (double u : rootsInside(slope))
    if (u > inset && u < 1 - inset) stops.push_back(u);
  stops.push_back(1 - inset);
  return stops;
}

double crossing(const Piece& p, double level, double from, double to) {
  const bool inside = p(to) >= level;
  for (int n = 0; n < 60; ++n) {
    const double mid = 0.5 * (from + to);
    if (mid <= from || mid >= to) break;
    ((p(mid) >= level) == inside ? to : from) = mid;
  }
  return to;
}

}  // namespace vernier::quality
