// SPDX-License-Identifier: GPL-3.0-or-later
// Volume rendering on the CPU, without GL: what VolumeLayer in Scene.h means, with the tools that stand in
// the volume.
//
// Blend. A ray is cut to `region`, then at the tools: parts. Step k of the view's lattice covers [k, k + 1)
// step_mm from the lattice's origin, and its sample stands in its middle (its two, where pre-integrated, at
// its ends), wherever the part begins or ends: a step that a part has only the share w of counts with the
// opacity 1 - (1 - A)^w. Positions outside the box of voxel centres are moved to it, axis by axis. Front to
// back: C += T A c, T *= 1 - A, until T < leastLight. Translucent tools are composited at their distance; the
// tool that ends the ray, or the scene's background, stands behind: C + T * E. Samples without data are
// transparent.
//   Post: A and c of the interpolated value. Pre: voxels' opacities a (of opacityLength_mm) and a c are
//   interpolated, then A = 1 - (1 - a)^(step / length). PreIntegrated: A and A c by the table.
//   Shading: c is lit by the gradient at the step's middle.
//   Colour volumes: channels times gains, clamped; A = 1 - (1 - alpha)^(step / smallest spacing). Post only,
//   not shaded.
// Max, Min: K + T a c + (1 - a) T' E: value, place and so T by Projection.h; a, c of the transfer function at
// the value (a not scaled by any length); K: the translucent tools' colours, each weakened by those before it
// and by 1 - a behind the extremum; T' and E: all tools and what ends the ray. Of colour volumes: each
// channel as a projection of its own, whose grey is the channel times its gain.
//
// Two ways: in float by SIMD, 16 neighbouring rays at a time (even grids of U8, U16, I16 and F32, one
// rescale, linear, Post or PreIntegrated; positions to 1e-6 voxel, transfer functions by tables), else in
// double, sample by sample.
//
// Frames: Pixel (centres at half-integers, row 0 on top), rays in patient mm by CameraPicture. Threads: tiles
// by parallelFor: bit-equal for any number of threads, and with or without `visible`. The stop token is read
// once per row of packets. Errors: Cancelled; Internal for a job whose parts do not fit together.
// Sources: Max, Optical Models for Direct Volume Rendering, 1995; Rezk-Salama 2000, equation 6 and section
// 4.2; early termination: Levoy 1990.
#pragma once
#include <memory>
#include <stop_token>
#include <vector>

#include "vernier/native/Projection.h"
#include "vernier/volume/TransferTable.h"

namespace vernier::native {

// Which parts of a volume may show anything under a transfer function (or reach a level): made anew whenever
// the function changes, in a millisecond or two.
class VisibleBricks;
// `entries` of the table that will be read.
VERNIER_API std::shared_ptr<const VisibleBricks> visibleBricks(const ProjectionBounds&,
                                                               const TransferFunction&,
                                                               const Volume::Range& tableRange, int entries);
VERNIER_API std::shared_ptr<const VisibleBricks> bricksReaching(const ProjectionBounds&, double level);
VERNIER_API std::uint64_t bytesOf(const VisibleBricks&);

// Early termination leaves out at most this share of the light: 0.26 and 0.026 levels of 255.
inline constexpr double kReviewLeastLight = 1e-3, kReferenceLeastLight = 1e-4;

inline constexpr std::size_t kMostInsides = 8;
// What a lens shows of the same volume, by the same rules, where appearances are drawn together.
struct VolumeInside {
  const VisibleBricks* visible = nullptr;
  const TransferFunction* function = nullptr;  // null: nothing
  const TransferTable* table = nullptr;
  const PreIntegratedTable* preIntegrated = nullptr;
};

struct VolumeRenderJob {
  const Volume* volume = nullptr;
  const VisibleBricks* visible = nullptr;    // of Blend; null: nothing is left out
  const ProjectionBounds* bounds = nullptr;  // of Max and Min, and where the volume may hold no-data
  CameraPicture camera;
  std::vector<HalfSpace> region;  // keptRegion()
  VolumeMode mode = VolumeMode::Blend;
  Classification classification = Classification::Post;
  OpacityRule opacity = OpacityRule::Exact;
  Interpolation interpolation = Interpolation::Linear;
  ShadingModel shading = ShadingModel::None;
  Material material;
  std::vector<Light> lights;  // none: a white one at the eye
  std::array<double, 4> gains{1, 1, 1, 1};
  const TransferFunction* function = nullptr;         // checked; of grey volumes
  const TransferTable* table = nullptr;               // of Post, for step_mm
  const PreIntegratedTable* preIntegrated = nullptr;  // of PreIntegrated, for step_mm
  double step_mm = 1;                                 // of the sampling lattice
  bool exact = false;                                 // of Max and Min: cell by cell where that is possible
  double leastLight = kReviewLeastLight;
  Rgb background;
  const SurfaceHits* tools = nullptr;  // of the same camera; null: none
  RaysOfPass rays;                     // of Blend, where the images have rays that are cut at lenses
  std::vector<VolumeInside> insides;   // of rays with Together: of each lens of images.rays
};

// True when the SIMD kernel will draw the job; for cost models and tests.
VERNIER_API bool rendersFast(const VolumeRenderJob&);

// Where images.rays is set and all appearances are drawn together, samples are read once, where they are
// without lenses, whatever the lenses show; images.rays is taken away. Else rays that meet a lens are left to
// their parts (RayIntervals.h), of which the job draws those that `rays` names, and pixels are written only
// if it draws plain rays. Fills colour and depth (mm along the ray: where the accumulated opacity passes 0.5,
// within the step by its extinction; Max and Min: where the extremum lies; kNothing_mm where neither is).
// Writes every pixel. Adds samples to the counters.
VERNIER_API Result<void> renderVolume(const VolumeRenderJob&, Images&, std::stop_token = {});

}  // namespace vernier::native
