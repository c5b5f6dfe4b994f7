// SPDX-License-Identifier: GPL-3.0-or-later
// Polynomials of low degree on [0, 1].
#pragma once
#include <array>
#include <vector>

namespace vernier::quality {

// Coefficients of 1, u, u^2, ... u^9: cubic interpolation along a line has the ninth.
struct Poly {
  std::array<double, 10> c{};
  int degree = 0;
  double operator()(double u) const {
    double v = c[static_cast<std::size_t>(degree)];
    for (int n = degree - 1; n >= 0; --n) v = v * u + c[static_cast<std::size_t>(n)];
    return v;
  }
};

Poly derivative(const Poly&);
Poly operator*(const Poly&, const Poly&);
Poly operator-(const Poly&, const Poly&);
Poly operator+(const Poly&, const Poly&);

// The line from a at u = 0 to b at u = 1.
inline Poly line(double a, double b) { return Poly{{a, b - a}, a == b ? 0 : 1}; }
// (1 - f) p + f q
Poly mix(const Poly& p, const Poly& q, const Poly& f);

// Real roots in the open interval (0, 1), ascending; double roots may be left out, where the sign does not
// change. Up to degree 2 in closed form, above by bisection between the roots of the derivative.
std::vector<double> rootsInside(const Poly&);

}  // namespace vernier::quality
