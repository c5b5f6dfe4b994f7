// SPDX-License-Identifier: GPL-3.0-or-later
// Order, fit and validation of the slices of one stack: pure functions over positions. Lengths mm, frame
// Patient (LPS). Rules: docs/studies.md, "Geometry"; order from position along the normal only, never from
// instance numbers.
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "vernier/study/Model.h"

namespace vernier {

inline constexpr double kOrthonormalSilent = 1e-4;   // fixed without a word
inline constexpr double kOrthonormalFlagged = 1e-2;  // fixed and flagged; beyond: no 3-D
inline constexpr double kCoincident_mm = 1e-4;
inline constexpr double kGapFactor = 1.5;  // of the median step
inline constexpr double kUniformOfStep = 0.02, kUniformOfSpacing = 0.25;
inline constexpr double kShear_deg = 0.1;
inline constexpr double kMinSpacing_mm = 1e-4, kMaxSpacing_mm = 1e3;

// Gram-Schmidt: row kept in direction, column made orthogonal. nullopt: not finite, zero or parallel.
std::optional<FramePlane> orthonormalPlane(const glm::dvec3& position, const glm::dvec3& row,
                                           const glm::dvec3& column);

// The least-squares straight even line o(k) = first + k * step through origins at places k.
struct EvenLine {
  glm::dvec3 first{0}, step{0};
};
EvenLine fitLine(const std::vector<glm::dvec3>& origins, const std::vector<double>& places);

// One slice as the fit sees it. `tie` orders slices at one position (instance number, then place in the
// scan).
struct SlicePlane {
  FramePlane plane;
  std::int64_t tie = 0;
};
// Indices in ascending order along the normal row x column of the first plane.
std::vector<std::size_t> orderAlongNormal(const std::vector<SlicePlane>& slices);

// Fills shape, grid, positions, step, shear, deviation, volume3d, why2d and the geometric findings of `stack`
// from its planes, which are in order. spacing: row\column; 0 = unknown.
void fitGeometry(const std::vector<FramePlane>& planes, std::int64_t rows, std::int64_t columns,
                 glm::dvec2 spacing_mm, Stack& stack);

double median(std::vector<double> values);

}  // namespace vernier
