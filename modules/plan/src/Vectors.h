// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors that may be hostile: not finite, too long to square, too short.
#pragma once
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace vernier {

inline bool finite(glm::dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Unit vector, also for lengths whose square would overflow or vanish; zero for a zero or non-finite vector.
inline glm::dvec3 unit(glm::dvec3 v) {
  if (!finite(v)) return glm::dvec3(0);
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (largest == 0) return glm::dvec3(0);
  return glm::normalize(v / largest);
}

// Vectors at a smaller angle (rad) than this span no plane.
inline constexpr double kLeastAngle_rad = 1e-6;

}  // namespace vernier
