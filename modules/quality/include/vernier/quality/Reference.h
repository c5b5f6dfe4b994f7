// SPDX-License-Identifier: GPL-3.0-or-later
// The truth that pictures are measured against: pixels of a scene in double precision, each on its own, at
// the pixel's centre. Slices and images; surfaces by themselves (beside a slice they are outlines, which no
// error is taken of); layers of plugins that bring their own truth. A scene with any other layer is refused
// (NotBuiltYet).
//
// Shares with the engines only the scene, voxel access and the default window: camera and plane geometry,
// interpolation (GridGeometry.h: true slice positions, gaps, border held for half a voxel, no-data
// renormalised over the valid corners), windows (PS3.3 C.11.2.1.2) and compositing are its own.
//
// A slab is the line through [-T/2, T/2] along the normal, cut at every cell face, gap and border. Along each
// piece a trilinear field is a cubic (next to no-data a ratio of two cubics): its maximum and minimum come
// from the roots of the derivative, its mean from exact integration over the valid length. So nothing can be
// stepped over.
//
// Surfaces: every triangle that the pixel's ray meets, in double, in order along the ray.
//
// Thread-safe; spreads the pixels with parallelFor. Errors: SceneInvalid (a source is missing, a pixel lies
// outside the picture), PlaneDegenerate, NotBuiltYet, Cancelled.
#pragma once
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "vernier/plan/Scene.h"
#include "vernier/plan/Technique.h"
#include "vernier/plan/View.h"

namespace vernier::quality {

// Model: against the continuous truth, so it holds all that the technique does. Implementation: against a
// double evaluation of the same algorithm (slabs: the same midpoint samples), so it holds the arithmetic
// only.
enum class ErrorKind { Model, Implementation };

struct ReferenceOptions {
  ErrorKind kind = ErrorKind::Model;
  double step =
      1;  // of Quality, for Implementation: a slab takes ceil(T / (step * smallest spacing)) samples
  // By the layer's place in the scene: what a plugin says of its own layers (Technique::truth). Such a layer
  // lies over those before it and adds no pixels to the population, unless the scene has no other layer.
  std::map<std::size_t, PixelTruth> truths = {};
};

struct ReferencePixel {
  glm::dvec4 rgba{0, 0, 0, 1};                              // display-referred 0..1, background included
  double value = std::numeric_limits<double>::quiet_NaN();  // modality value before the window; NaN: no data
  bool covered = false;                                     // some layer has data here
};

// `pixels`: index x + width * y, row 0 on top. One answer per index, in their order.
VERNIER_API Result<std::vector<ReferencePixel>> referencePixels(const Scene&, const View&, const Sources&,
                                                                std::span<const std::size_t> pixels,
                                                                const ReferenceOptions& = {},
                                                                std::stop_token = {});

// The value of one slice layer at points of the picture (pixel coordinates, centres at half-integers), with
// the least and greatest modality value of the voxels that it is made from (the corners of the cells that it
// passes).
struct SliceValue {
  double value = 0;
  double localMin = 0, localMax = 0;
  double localRange() const { return localMax - localMin; }
};
VERNIER_API Result<std::vector<std::optional<SliceValue>>> sliceValues(const Scene&, std::size_t layer,
                                                                       const View&, const Sources&,
                                                                       std::span<const glm::dvec2> points_px,
                                                                       const ReferenceOptions& = {});

// Number of midpoint samples of a slab: ceil(T / (step * smallest spacing)), at least 1.
VERNIER_API int slabSamples(const Volume&, double thickness_mm, double step);

}  // namespace vernier::quality
