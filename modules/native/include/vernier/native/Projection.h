// SPDX-License-Identifier: GPL-3.0-or-later
// Projections on the CPU, without GL: what each pixel's ray through a volume amounts to (ProjectionLayer in
// Scene.h says what the modes mean), with the tools that stand in it.
//
// A ray is cut to `region`, then at the tools: parts. Along a part the field is trilinear (or nearest), as
// GridGeometry.h defines the grid; no-data takes no part. Two ways:
//   Sampled: at the view's lattice, (k + 1/2) step_mm from the eye, cut steps at what is left of them. In
//     float by SIMD (even grids of U8, U16, I16 and F32, one rescale, linear interpolation, a window that is
//     a ramp; positions to 1e-6 voxel), else in double, sample by sample.
//   Exact: cell by cell in double. Extrema are the ends and the roots of the derivative of each cell's cubic;
//     integrals are exact for the cubic, cut where it crosses the window's ends.
// Extrema leave out what cannot win, by bounds over bricks; the sum leaves out what emits nothing.
//
// Parts join front to back. A tool weakens every contribution behind it by 1 - alpha: T. K: the translucent
// tools' own colours, weakened; E: T times the colour of the tool that ends the ray, 0 without one. A ray
// with data shows, g being the window's grey:
//   Max          K + max(greatest T g (1 - cue + cue z'), E), in each channel
//   Min          K + max(least T g, E)
//   Mean         K + max(g of the mean value * mean of T, E); means over the length with data
//   Sum          K + gain * integral of T g + E; without a tool at its end T times the scene's background
//   Attenuation  every colour weakened by exp(-gain * integral of g before it), T times a background of 1
//   invert       in complements: tools' colours c become 1 - c, then the pixel becomes 1 - pixel
// A ray without data: K + E, or K + T times the scene's background; Sum and Attenuation as above.
//
// In a picture with lenses (Images::rays, plan/RayIntervals.h) rays that meet none are drawn so, where
// ProjectionJob::rays says it. Of the others the parts of its appearance are gathered, each weakened by its
// weight, with the samples and steps that the whole ray would have; a sample of an extremum belongs to the
// part that holds the middle of its step, a step of an integral to both sides by their shares. What they come
// to together stands in the first of them: the grey before tools and background, of Attenuation what is let
// through.
//
// Frames: Pixel (centres at half-integers, row 0 on top), rays in patient mm by CameraPicture. Threads: tiles
// by parallelFor, every pixel by itself: bit-equal for any number of threads. The stop token is read once per
// row of a tile. Errors: Cancelled; Internal for a job that whyNot..() names.
#pragma once
#include <functional>
#include <limits>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "vernier/native/Surfaces.h"
#include "vernier/plan/RayIntervals.h"
#include "vernier/plan/Volumetric.h"
#include "vernier/volume/Volume.h"

namespace vernier::native {

// Bounds of the field over parts of a volume, for rays that leave out what cannot matter. Made once for a
// volume; reads every voxel, on all cores.
class ProjectionBounds;
VERNIER_API Result<std::shared_ptr<const ProjectionBounds>> projectionBounds(const Volume&);
VERNIER_API std::uint64_t bytesOfBounds(const GridGeometry&);

struct ProjectionJob {
  const Volume* volume = nullptr;            // grey
  const ProjectionBounds* bounds = nullptr;  // null: nothing is left out
  CameraPicture camera;
  std::vector<HalfSpace> region;  // keptRegion()
  ProjectionMode mode = ProjectionMode::Max;
  Interpolation interpolation = Interpolation::Linear;
  VoiWindow window;  // usable and normalised (Voi.h)
  bool invert = false;
  double cue = 0;  // of Max
  DepthRamp ramp;
  double gain_perMm = 1;
  double step_mm = 1;  // of the sampling lattice
  bool exact = false;
  Rgb background;
  const SurfaceHits* tools = nullptr;  // of the same camera; null: none
  RaysOfPass rays;                     // of a picture with lenses: what is drawn of it
};

// True when the SIMD kernel will sample the job; for cost models and tests.
VERNIER_API bool samplesFast(const ProjectionJob&);
// One sentence why the job cannot be drawn exactly; "" when it can.
VERNIER_API std::string whyNotExact(const ProjectionJob&);

// Fills colour, depth (mm along the ray: Max and Min where the extremum lies, or the tool that ends the ray
// when it is what is seen; else where the ray enters) and, when they have been allocated, values (Max, Min,
// Mean: modality; Sum, Attenuation: gain times the integral).
// Writes every pixel, in a picture with lenses those that meet none. Adds samples and cells to the counters.
VERNIER_API Result<void> drawProjection(const ProjectionJob&, Images&, std::stop_token = {});

// What one part of a ray, [from_mm, to_mm], amounts to. Extrema: `best` in modality values, NaN where no data
// lay; with a cue it is the cued grey. Emission: `integral` of the clamped grey. Mean: integral of the
// modality value. `length_mm`: with data (Emission: of the part).
struct Gathered {
  double best = std::numeric_limits<double>::quiet_NaN();
  double at_mm = 0;
  double integral = 0, length_mm = 0;
};

// A stretch of a ray. One that begins or ends inside is cut out of a longer one, [begin_mm, end_mm], and
// keeps its samples where they are.
struct RayStretch {
  double from_mm = 0, to_mm = 0;
  bool beginsInside = false, endsInside = false;
  double begin_mm = 0, end_mm = 0;

  // Beyond these no sample lies, and the step that holds one of them is cut there.
  double least_mm() const { return beginsInside ? begin_mm : from_mm; }
  double most_mm() const { return endsInside ? end_mm : to_mm; }
};

// For engines that read the volume by themselves: the same parts of rays, joined by the same rules.
struct RayPart {
  int x = 0, y = 0;        // pixel
  std::size_t passed = 0;  // parts of the ray before it, or translucent tools that the ray has passed
  PatientRay ray;
  double rayPerDepth = 1;
  RayStretch along;
};
using PartReader = std::function<Gathered(const RayPart&)>;
// As above, but for the samples and the counters. The reader is called from many threads, for each part of a
// pixel once and in its order.
VERNIER_API Result<void> drawProjection(const ProjectionJob&, const PartReader&, Images&,
                                        std::stop_token = {});

// The steps of the lattice that a part meets: step k covers [k, k + 1) * step_mm and is sampled at its
// middle, cut steps at the middle of what is left of them. Extrema take the steps before and behind too:
// their samples are moved to the part's ends; where it begins or ends inside, steps whose middle it holds.
struct Steps {
  std::int64_t first = 0, count = 0;
};
VERNIER_API Steps stepsOf(double from_mm, double to_mm, double step_mm, bool extreme);
VERNIER_API Steps stepsOf(const RayStretch&, double step_mm, bool extreme);

}  // namespace vernier::native
