// SPDX-License-Identifier: GPL-3.0-or-later
#include "PortableMath.h"

#include <cmath>
#include <cstdint>

namespace vernier::phantoms {
namespace {

// Taylor series on [-pi/4, pi/4]; the first dropped term is below 1e-17.
double sinCore(double x) {
  const double s = x * x;
  double sum = 0.0;
  for (int n = 17; n >= 3; n -= 2) sum = (1.0 + sum) * (-s / (n * (n - 1.0)));
  return x * (1.0 + sum);
}
double cosCore(double x) {
  const double s = x * x;
  double sum = 0.0;
  for (int n = 18; n >= 2; n -= 2) sum = (1.0 + sum) * (-s / (n * (n - 1.0)));
  return 1.0 + sum;
}

// x = quarter * pi/2 + rest, with pi/2 in two parts: the first has 33 bits, so that its product with quarter
// is exact.
double reduce(double x, std::int64_t& quarter) {
  constexpr double kHigh = 1.57079632673412561417, kLow = 6.07710050650619224932e-11;
  const double q = std::floor(x / kHigh + 0.5);
  quarter = static_cast<std::int64_t>(q);
  return (x - q * kHigh) - q * kLow;
}

}  // namespace

double portableSin(double x) {
  std::int64_t quarter = 0;
  const double r = reduce(x, quarter);
  switch (quarter & 3) {
    case 0:
      return sinCore(r);
    case 1:
      return cosCore(r);
    case 2:
      return -sinCore(r);
    default:
      return -cosCore(r);
  }
}

double portableCos(double x) {
  std::int64_t quarter = 0;
  const double r = reduce(x, quarter);
  switch (quarter & 3) {
    case 0:
      return cosCore(r);
    case 1:
      return -sinCore(r);
    case 2:
      return -cosCore(r);
    default:
      return sinCore(r);
  }
}

// exp(x) = 2^n * exp(r), |r| <= ln(2)/2, ln 2 in two parts; ldexp is exact.
double portableExp(double x) {
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  const double n = std::floor(x / kLn2High + 0.5);
  const double r = (x - n * kLn2High) - n * kLn2Low;
  double sum = 1.0;
  for (int k = 18; k >= 1; --k) sum = 1.0 + sum * (r / k);
  return std::ldexp(sum, static_cast<int>(n));
}

}  // namespace vernier::phantoms
