// SPDX-License-Identifier: GPL-3.0-or-later
// The cubic between two samples as the blend of two parabolas, each through three of four samples, in
// Lagrange's form. Written once for numbers and for polynomials in u.
#pragma once
#include <array>

#include "Polynomial.h"

namespace vernier::quality {

inline double scaled(double k, double x) { return k * x; }
inline Poly scaled(double k, Poly p) {
  for (double& c : p.c) c *= k;
  return p;
}
inline double constantLike(double x, double) { return x; }
inline Poly constantLike(double x, const Poly&) { return Poly{{x}, 0}; }

// The parabola through the samples at a, b and c, as their weights at t.
template <class X>
std::array<X, 3> parabola(double a, double b, double c, const X& t) {
  const X ta = t - constantLike(a, t), tb = t - constantLike(b, t), tc = t - constantLike(c, t);
  return {scaled(1 / ((a - b) * (a - c)), tb * tc), scaled(1 / ((b - a) * (b - c)), ta * tc),
          scaled(1 / ((c - a) * (c - b)), ta * tb)};
}

// Weights of the four samples at -before, 0, 1 and 1 + after; 0 for a distance: that one is not there.
template <class X>
std::array<X, 4> overhauser(double before, double after, const X& t) {
  const X one = constantLike(1, t), none = constantLike(0, t);
  if (before == 0 && after == 0) return {none, one - t, t, none};
  std::array<X, 3> l, r;
  if (before > 0) l = parabola(-before, 0, 1, t);
  if (after > 0) r = parabola(0, 1, 1 + after, t);
  if (after == 0) return {l[0], l[1], l[2], none};
  if (before == 0) return {none, r[0], r[1], r[2]};
  const X u = one - t;
  return {u * l[0], u * l[1] + t * r[0], u * l[2] + t * r[1], t * r[2]};
}

}  // namespace vernier::quality
