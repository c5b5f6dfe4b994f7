// SPDX-License-Identifier: GPL-3.0-or-later
// Angles as types, so that degrees never meet radians by accident. Other numbers carry a suffix in their
// name: _mm _val (modality value) _hu _ms _px _deg.
#pragma once
#include <numbers>

namespace vernier {

struct Radians;
struct Degrees {
  double deg = 0;
  explicit constexpr Degrees(double d = 0) : deg(d) {}
  explicit constexpr Degrees(Radians r);
  friend bool operator==(Degrees, Degrees) = default;
};
struct Radians {
  double rad = 0;
  explicit constexpr Radians(double r = 0) : rad(r) {}
  explicit constexpr Radians(Degrees d) : rad(d.deg * std::numbers::pi / 180.0) {}
  friend bool operator==(Radians, Radians) = default;
};
constexpr Degrees::Degrees(Radians r) : deg(r.rad * 180.0 / std::numbers::pi) {}

}  // namespace vernier
