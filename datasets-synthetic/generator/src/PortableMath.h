// SPDX-License-Identifier: GPL-3.0-or-later
// sin, cos and exp whose every bit is fixed by IEEE 754 (+, -, *, / only), since those of the C library
// differ between versions in the last place and a phantom must be the same bytes everywhere. Errors below
// 1e-14 in the ranges used here (|x| <= 1e4 rad; exp for -700 <= x <= 700). sqrt, floor and fabs are exact by
// the standard and used as they are.
#pragma once

namespace vernier::phantoms {

inline constexpr double kPi = 3.14159265358979323846;

double portableSin(double x);
double portableCos(double x);
double portableExp(double x);
inline double radiansOf(double deg) { return deg * (kPi / 180.0); }

}  // namespace vernier::phantoms
