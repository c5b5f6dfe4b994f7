// SPDX-License-Identifier: GPL-3.0-or-later
// Cubic interpolation: what it means here, in one place.
//
// Between two samples the value is the cubic whose slope at each of them is that of the parabola through it
// and its two neighbours (equally: the blend of both parabolas, Overhauser 1968). On even samples that is
// cubic convolution with a = -1/2 (R. G. Keys, Cubic convolution interpolation for digital image processing,
// IEEE Trans. ASSP 29, 1981), also known as Catmull-Rom. Where a sample has one neighbour only (the end of an
// axis, beside a gap) the parabola of the other side serves alone, which on even samples is Keys' boundary
// condition; with none, the line. In three dimensions the axes are interpolated one after the other: 64
// voxels.
//
// Why this kernel: it passes through the samples, so a reading at a voxel's centre is the stored value (a
// B-spline needs a prefilter over the whole volume for that, and padding would spread through it); it is
// exact for quadratics, and its error falls with the third power of the spacing, linear's with the second.
// Overshoot: in one dimension up to 1/8 of the range of its four samples (7.4 % beside a single sharp edge);
// in three at most 0.477 of the range of the 64 voxels.
#pragma once
#include <array>

namespace vernier {

// A neighbour nearer than half or further than twice the distance between the two samples does not count: its
// parabola would blow noise up. (Uneven slices; even samples are always 1.)
inline constexpr double kNearestNeighbour = 0.5, kFurthestNeighbour = 2.0;

// Weights of the samples s - 1, s, s + 1, s + 2 for a position t in [0, 1] from s to s + 1. `before` and
// `after`: distances from s - 1 to s and from s + 1 to s + 2, in those from s to s + 1; 0: there is none.
inline std::array<double, 4> cubicWeights(double t, double before, double after) {
  const double u = 1 - t;
  const bool left = before > 0, right = after > 0;
  if (!left && !right) return {0, u, t, 0};
  if (!left)
    return {0, u * (1 + after - t) / (1 + after), t * (1 + after - t) / after,
            -t * u / (after * (1 + after))};
  if (!right)
    return {-t * u / (before * (1 + before)), u * (t + before) / before, t * (t + before) / (1 + before), 0};
  // Hermite's form; d0 and d1 are what the slopes take from both samples' own difference.
  const double h0 = t * u * u, h1 = -t * t * u;
  const double far0 = 1 / (before * (1 + before)), near0 = before / (1 + before);
  const double far1 = 1 / (after * (1 + after)), near1 = after / (1 + after);
  return {-h0 * far0, (1 + 2 * t) * u * u + h0 * (far0 - near0) - h1 * near1,
          t * t * (3 - 2 * t) + h0 * near0 + h1 * (near1 - far1), h1 * far1};
}

}  // namespace vernier
