// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures with lenses on the CPU (Ropinski, Steinicke, Hinrichs 2005, section 3; RayIntervals.h): rays are
// cut at the faces of convex regions and at tools before anything is drawn, so that no sample is ever tested
// against a lens; and what was drawn of their parts is joined.
//
// Where a ray enters and leaves a lens is computed in double: against all faces up to kAnalyticFacets of
// them, above that against the two faces that the rasteriser finds on the pixel (edge functions in double).
// Both give the same intervals; those of the parts are rounded to float. Depth along the camera's axis, or 1
// / that in perspective, changes evenly over the picture along a face: a pixel costs a division, no ray.
//
// Frames: Pixel (centres at half-integers, row 0 on top), mm along the rays of CameraPicture. Threads: rows
// by parallelFor, the same bits for any number of them. The stop token is read once per row. Errors:
// Cancelled; Internal for images without parts.
#pragma once
#include <memory>
#include <stop_token>
#include <vector>

#include "vernier/base/ConvexRegion.h"
#include "vernier/native/Surfaces.h"
#include "vernier/plan/Volumetric.h"

namespace vernier::native {

inline constexpr std::size_t kAnalyticFacets = 16;

using vernier::LensSpans;
struct LensRaysJob {
  CameraPicture camera;
  std::vector<HalfSpace> region;                            // keptRegion()
  std::vector<std::shared_ptr<const ConvexRegion>> lenses;  // appearance n is the n-th from 1; the later wins
  const SurfaceHits* tools = nullptr;                       // of the same camera; null: none
  const std::vector<LensSpans>* known = nullptr;            // of each lens; null: they are found here
};

VERNIER_API LensSpans lensSpans(const ConvexRegion&, const CameraPicture&, bool rasterised);

// Makes images.rays anew. Nothing else of the images is touched.
VERNIER_API Result<void> cutRays(const LensRaysJob&, Images&, std::stop_token = {});
// The same for appearances drawn together: RayIntervals::lenses. Region and tools are theirs who draw.
VERNIER_API Result<void> markLenses(const LensRaysJob&, Images&, std::stop_token = {});

struct JoinJob {
  std::vector<Accumulator> accumulators;  // of each appearance
  // Sum: what the appearance adds up lies over the scene's background (projections), or over black (shells).
  std::vector<bool> overBackground;
  // Max of shells, of each appearance; absent: black, and no. What is shown at least where no tool ends the
  // ray (beta0 phi0), and whether an opaque tool is not seen behind what has been gathered.
  std::vector<glm::dvec3> least;
  std::vector<bool> replaces;
  glm::dvec3 background{0};
};
// Writes colour and depth of the pixels that meet a lens, and takes images.rays away.
VERNIER_API Result<void> joinParts(const JoinJob&, Images&, std::stop_token = {});

}  // namespace vernier::native
