// SPDX-License-Identifier: GPL-3.0-or-later
// Draws triangle surfaces on the CPU. A pixel is sampled at its centre; which triangles cover it is decided
// by edge functions in double with the top-left rule, so that a pixel on an edge that two triangles share is
// covered exactly once. Nothing is clipped: edge functions work on homogeneous points, so that a triangle
// that passes beside or through the eye needs no care. Hits are distances along the pixel's ray in mm
// (CameraPicture.h).
//
// Both sides are drawn. Light: a headlight at the eye, colour * (ambient + diffuse |cos|) with the triangle's
// own normal and the pixel's ray. Hits within kSamePlace of each other count as at one place: there the
// surface that comes later in the list lies in front. Opacity 1 ends the ray; below 1 a hit covers what is
// behind by its opacity; surfaces of opacity 0 are not touched.
//
// Spread over tiles with parallelFor: the same bits for any number of threads. Checks the stop token per tile
// (Cancelled). OutOfMemory by guarded() callers.
#pragma once
#include <stop_token>
#include <vector>

#include "vernier/plan/CameraPicture.h"
#include "vernier/plan/Frame.h"
#include "vernier/plan/Technique.h"

namespace vernier::native {

inline constexpr double kAmbient = 0.2, kDiffuse = 0.8;
inline constexpr double kSamePlace = 1e-9;  // of the distance from the eye
// Translucent hits that a ray is given one by one; those behind them are joined to one (SurfaceHits::Tail).
inline constexpr std::size_t kSurfaceLayers = 8;

struct SurfaceJob {
  std::vector<PlacedSurface> surfaces;
  CameraPicture camera;
  glm::dvec3 background{0};
};

// Colour over the background, and the depth of the first opaque hit. Any number of translucent hits is
// resolved.
VERNIER_API Result<void> drawSurfaces(const SurfaceJob&, Images&, std::stop_token);

// The same hits for whoever draws something between them: where each ray ends, and what it passes before.
struct SurfaceHits {
  struct Layer {
    float t_mm = 0;
    float r = 0, g = 0, b = 0;  // premultiplied by alpha
    float alpha = 0;
  };
  int width = 0, height = 0;
  std::vector<float> end_mm;         // of the first opaque hit; kNothing_mm where there is none
  std::vector<float> endColour;      // 3 per pixel, of that hit
  std::vector<std::uint32_t> first;  // per pixel into layers, and one more
  std::vector<Layer> layers;         // nearest first, at most kSurfaceLayers + 1 per pixel
  // Where a pixel has more: the last of its layers joins all that are behind the first kSurfaceLayers, at the
  // place of the nearest of them. How much that may matter is said here.
  std::uint64_t pixelsBeyond = 0;
  double largestResidual = 0;  // weight (0..1) in the picture of what was joined
  Counters counters;
};
VERNIER_API Result<SurfaceHits> findSurfaces(const SurfaceJob&, std::stop_token);

}  // namespace vernier::native
