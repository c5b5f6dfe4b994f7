// SPDX-License-Identifier: GPL-3.0-or-later
#include "Polynomial.h"

#include <algorithm>
#include <cmath>

#include "vernier/base/Result.h"

namespace vernier::quality {
namespace {

std::size_t at(int n) { return static_cast<std::size_t>(n); }

void quadraticRoots(const Poly& p, std::vector<double>& out) {
  const double c = p.c[0], b = p.c[1], a = p.degree == 2 ? p.c[2] : 0.0;
  const double scale = std::max({std::abs(a), std::abs(b), std::abs(c)});
  if (scale == 0) return;
  const double disc = b * b - 4 * a * c;
  if (disc < 0) return;
  // The larger root first; the other from the product, so that nothing cancels.
  const double q = -0.5 * (b + std::copysign(std::sqrt(disc), b));
  for (double r : {a != 0 ? q / a : -1.0, q != 0 ? c / q : -1.0})
    if (r > 0 && r < 1) out.push_back(r);
  std::sort(out.begin(), out.end());
}

double bisect(const Poly& p, double lo, double hi) {
  const bool negativeAtLo = p(lo) < 0;
  for (int n = 0; n < 60; ++n) {
    const double mid = 0.5 * (lo + hi);
    if (mid <= lo || mid >= hi) break;
    ((p(mid) < 0) == negativeAtLo ? lo : hi) = mid;
  }
  return 0.5 * (lo + hi);
}

}  // namespace

Poly derivative(const Poly& p) {
  Poly d;
  d.degree = std::max(0, p.degree - 1);
  for (int n = 1; n <= p.degree; ++n) d.c[at(n - 1)] = n * p.c[at(n)];
  return d;
}

Poly operator*(const Poly& p, const Poly& q) {
  Poly r;
  r.degree = p.degree + q.degree;
  VERNIER_ASSERT(r.degree < static_cast<int>(r.c.size()));
  for (int i = 0; i <= p.degree; ++i)
    for (int j = 0; j <= q.degree; ++j) r.c[at(i + j)] += p.c[at(i)] * q.c[at(j)];
  return r;
}

Poly operator+(const Poly& p, const Poly& q) {
  Poly r;
  r.degree = std::max(p.degree, q.degree);
  for (int n = 0; n <= r.degree; ++n) r.c[at(n)] = p.c[at(n)] + q.c[at(n)];
  return r;
}

Poly operator-(const Poly& p, const Poly& q) {
  Poly r;
  r.degree = std::max(p.degree, q.degree);
  for (int n = 0; n <= r.degree; ++n) r.c[at(n)] = p.c[at(n)] - q.c[at(n)];
  return r;
}

Poly mix(const Poly& p, const Poly& q, const Poly& f) { return p + f * (q - p); }

std::vector<double> rootsInside(const Poly& p) {
  std::vector<double> roots;
  if (p.degree <= 2) {
    quadraticRoots(p, roots);
    return roots;
  }
  double lo = 0;
  std::vector<double> stops = rootsInside(derivative(p));
  stops.push_back(1);
  for (double hi : stops) {
    if ((p(lo) < 0) != (p(hi) < 0)) roots.push_back(bisect(p, lo, hi));
    lo = hi;
  }
  return roots;
}

}  // namespace vernier::quality
