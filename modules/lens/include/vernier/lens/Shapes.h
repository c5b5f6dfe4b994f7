// SPDX-License-Identifier: GPL-3.0-or-later
// From a lens's shape to its faces: boxes, spheres, cones and prisms in closed form, hulls by CGAL's exact
// predicates (EPICK), which no header shows.
//
// A hull keeps every point that was given to within 1e-12 of its size; triangles that float32 could turn
// inside out (thinner than 2^-21 of half its diagonal) are taken away with their corner, which moves the
// surface by less than that. So corners that are rounded to float32 from the middle of their box turn no
// face over. More than kMostHullPoints points on the surface are thinned, and ConvexRegion::notice says by
// how much the hull is smaller.
//
// Refused with a sentence (SceneInvalid): what has no volume (fewer than four points, all equal, in a line,
// in a plane, thinner than a millionth of its length), numbers that are not finite or above kFarthest_mm,
// meshes that are not convex unless their hull is asked for, poses that flatten. Safe on any thread.
#pragma once
#include <cstddef>
#include <memory>

#include "vernier/base/Cache.h"
#include "vernier/base/ConvexRegion.h"
#include "vernier/base/Result.h"
#include "vernier/plan/Scene.h"
#include "vernier/plan/Technique.h"

namespace vernier::lens {

inline constexpr double kFarthest_mm = 1e7;  // of any coordinate, in the lens's frame and in the patient
inline constexpr double kLeast_mm = 1e-6;    // of any size
inline constexpr std::size_t kMostHullPoints = 16384;

// The faces of the lens in the patient. Hulls and spheres are kept in the cache by shape, never by pose: a
// lens that moves costs no more than the transformation of its faces. A mesh is looked up in Sources.
Result<std::shared_ptr<const ConvexRegion>> convexRegion(const LensLayer&, const Sources&, DerivedCache&);

}  // namespace vernier::lens
