// SPDX-License-Identifier: GPL-3.0-or-later
// CIEDE2000 with the names of Sharma, Wu and Dalal 2005.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "vernier/measure/ImageMetrics.h"

namespace vernier::measure {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// In degrees, 0..360; 0 of no colour (eq. 7).
double hue(double b, double a) {
  if (a == 0 && b == 0) return 0;
  const double h = std::atan2(b, a) / kDegree;
  return h < 0 ? h + 360 : h;
}

double linear(double coded) {
  return coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
}

double labCurve(double t) {
  constexpr double d = 6.0 / 29;
  return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0 / 29;
}

}  // namespace

Lab labFromSrgb(double r, double g, double b) {
  const double R = linear(r), G = linear(g), B = linear(b);
  // IEC 61966-2-1; each row is divided by what white gives, so that white is L = 100 and a = b = 0.
  const double X = (0.4124 * R + 0.3576 * G + 0.1805 * B) / (0.4124 + 0.3576 + 0.1805);
  const double Y = 0.2126 * R + 0.7152 * G + 0.0722 * B;
  const double Z = (0.0193 * R + 0.1192 * G + 0.9505 * B) / (0.0193 + 0.1192 + 0.9505);
  const double fx = labCurve(X), fy = labCurve(Y), fz = labCurve(Z);
  return {116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)};
}

double ciede2000(const Lab& p, const Lab& q) {
  constexpr double k25to7 = 6103515625.0;  // 25^7
  const double C1 = std::hypot(p.a, p.b), C2 = std::hypot(q.a, q.b);
  const double mean7 = std::pow((C1 + C2) / 2, 7);
  const double G = 0.5 * (1 - std::sqrt(mean7 / (mean7 + k25to7)));  // eq. 4
  const double a1 = (1 + G) * p.a, a2 = (1 + G) * q.a;
  const double c1 = std::hypot(a1, p.b), c2 = std::hypot(a2, q.b);
  const double h1 = hue(p.b, a1), h2 = hue(q.b, a2);
  const double dL = q.L - p.L, dC = c2 - c1;
  double dh = h2 - h1;  // eq. 10
  if (c1 * c2 == 0)
    dh = 0;
  else if (dh > 180)
    dh -= 360;
  else if (dh < -180)
    dh += 360;
  const double dH = 2 * std::sqrt(c1 * c2) * std::sin(dh / 2 * kDegree);
  const double L = (p.L + q.L) / 2, C = (c1 + c2) / 2;
  double h = h1 + h2;  // eq. 14
  if (c1 * c2 != 0) {
    if (std::abs(h1 - h2) > 180) h += h < 360 ? 360 : -360;
    h /= 2;
  }
  const double T = 1 - 0.17 * std::cos((h - 30) * kDegree) + 0.24 * std::cos(2 * h * kDegree) +
                   0.32 * std::cos((3 * h + 6) * kDegree) - 0.20 * std::cos((4 * h - 63) * kDegree);
  const double turn = 30 * std::exp(-((h - 275) / 25) * ((h - 275) / 25));
  const double C7 = std::pow(C, 7);
  const double RC = 2 * std::sqrt(C7 / (C7 + k25to7));
  const double SL = 1 + 0.015 * (L - 50) * (L - 50) / std::sqrt(20 + (L - 50) * (L - 50));
  const double SC = 1 + 0.045 * C, SH = 1 + 0.015 * C * T;
  const double RT = -std::sin(2 * turn * kDegree) * RC;
  const double l = dL / SL, c = dC / SC, H = dH / SH;
  return std::sqrt(std::max(0.0, l * l + c * c + H * H + RT * c * H));
}

}  // namespace vernier::measure
