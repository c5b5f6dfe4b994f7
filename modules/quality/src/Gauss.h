// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals of smooth functions: Gauss-Legendre with 8 points, halved until two halves agree with the whole.
#pragma once
#include <cmath>

namespace vernier::quality {

// Exact for polynomials up to the fifteenth degree.
template <class Fn>
double gauss8(const Fn& f, double a, double b) {
  static constexpr double x[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                  0.9602898564975363};
  static constexpr double w[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                  0.1012285362903763};
  const double mid = 0.5 * (a + b), half = 0.5 * (b - a);
  double sum = 0;
  for (int n = 0; n < 4; ++n) sum += w[n] * (f(mid - half * x[n]) + f(mid + half * x[n]));
  return sum * half;
}

template <class Fn>
double halved(const Fn& f, double a, double b, double whole, int depth) {
  const double mid = 0.5 * (a + b);
  const double left = gauss8(f, a, mid), right = gauss8(f, mid, b);
  if (depth == 0 || std::abs(left + right - whole) <= 1e-12 * (1 + std::abs(whole))) return left + right;
  return halved(f, a, mid, left, depth - 1) + halved(f, mid, b, right, depth - 1);
}

// To 1e-12 of 1 + the integral, or to pieces of (b - a) / 4096.
template <class Fn>
double integral(const Fn& f, double a, double b) {
  return halved(f, a, b, gauss8(f, a, b), 12);
}

}  // namespace vernier::quality
