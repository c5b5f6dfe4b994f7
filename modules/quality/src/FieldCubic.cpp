// SPDX-License-Identifier: GPL-3.0-or-later
// The cubic field (volume/Cubic.h says what it means), for a point in numbers, along a piece of a line in
// polynomials.
#include "Field.h"
#include "Overhauser.h"

namespace vernier::quality {
namespace {

bool vanishes(double w) { return w == 0; }
bool vanishes(const Poly& w) { return w(0.5) == 0; }  // no weight has a zero within a cell

double between(double a, double, double) { return a; }
Poly between(double a, double b, const Poly&) { return line(a, b); }

// Beyond half or double the distance a neighbouring slice does not count.
double counted(double distance) { return distance >= 0.5 && distance <= 2 ? distance : 0; }

}  // namespace

// Distances from the slices of a cell to their outer neighbours, in the cell's own height.
std::pair<double, double> Field::outerSlices(const Span& k) const {
  const GridGeometry& g = v_.grid();
  const bool below = k.lo > 0, above = k.hi + 1 < g.slices;
  if (g.even()) return {below ? 1 : 0, above ? 1 : 0};
  const auto z = [&](std::int64_t s) { return g.sliceOrigin_vox[static_cast<std::size_t>(s)].z; };
  const double height = z(k.hi) - z(k.lo);
  return {below && !isGap(k.lo - 1) ? counted((z(k.lo) - z(k.lo - 1)) / height) : 0,
          above && !isGap(k.hi) ? counted((z(k.hi + 1) - z(k.hi)) / height) : 0};
}

template <class X>
std::optional<X> Field::cubicAcross(std::int64_t slice, glm::dvec3 mid, glm::dvec3 a, glm::dvec3 b,
                                    LocalRange& range) const {
  const GridGeometry& g = v_.grid();
  const glm::dvec2 o = offsetOf(slice);
  const auto x = spanOf(mid.x - o.x, a.x - o.x, b.x - o.x, g.columns);
  const auto y = spanOf(mid.y - o.y, a.y - o.y, b.y - o.y, g.rows);
  if (!x || !y) return std::nullopt;
  const auto along = [](const Span& s, std::int64_t n) {
    const X t = between(s.f0, s.f1, X());
    if (s.lo == s.hi) return overhauser(0.0, 0.0, constantLike(0, t));
    return overhauser(s.lo > 0 ? 1.0 : 0.0, s.hi + 1 < n ? 1.0 : 0.0, t);
  };
  const std::array<X, 4> wx = along(*x, g.columns), wy = along(*y, g.rows);
  X sum = constantLike(0, wx[0]);
  for (std::size_t j = 0; j < 4; ++j) {
    if (vanishes(wy[j])) continue;
    X row = constantLike(0, wx[0]);
    for (std::size_t i = 0; i < 4; ++i) {
      if (vanishes(wx[i])) continue;
      const auto value =
          voxel(x->lo - 1 + static_cast<std::int64_t>(i), y->lo - 1 + static_cast<std::int64_t>(j), slice);
      if (!value) return std::nullopt;
      range.add(*value);
      row = row + scaled(*value, wx[i]);
    }
    sum = sum + wy[j] * row;
  }
  return sum;
}

template <class X>
std::optional<X> Field::cubic(const Span& k, glm::dvec3 mid, glm::dvec3 a, glm::dvec3 b,
                              LocalRange* range) const {
  const X t = between(k.f0, k.f1, X());
  const auto [before, after] = k.lo == k.hi ? std::pair{0.0, 0.0} : outerSlices(k);
  const std::array<X, 4> w = overhauser(before, after, k.lo == k.hi ? constantLike(0, t) : t);
  LocalRange local;
  X sum = constantLike(0, t);
  for (std::size_t n = 0; n < 4; ++n) {
    if (vanishes(w[n])) continue;
    const auto value = cubicAcross<X>(k.lo - 1 + static_cast<std::int64_t>(n), mid, a, b, local);
    if (!value) return std::nullopt;
    sum = sum + w[n] * *value;
  }
  if (range) {
    range->add(local.min);
    range->add(local.max);
  }
  return sum;
}

std::optional<double> Field::cubicAt(const Span& k, glm::dvec3 p, LocalRange* range) const {
  return cubic<double>(k, p, p, p, range);
}

std::optional<Poly> Field::cubicAlong(const Span& k, glm::dvec3 mid, glm::dvec3 a, glm::dvec3 b,
                                      LocalRange* range) const {
  return cubic<Poly>(k, mid, a, b, range);
}

}  // namespace vernier::quality
