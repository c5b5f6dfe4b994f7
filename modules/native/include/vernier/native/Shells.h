// SPDX-License-Identifier: GPL-3.0-or-later
// Emission shells on the CPU (W. Heidrich, Hardware Accelerated Rendering of Emissive Volumes, 1996): where
// the rays of a picture meet closed iso-surfaces of a volume, and what the crossings amount to.
//
//   Max: the brightest crossing, at least beta0 phi0. Sum: all crossings added, front and back. Lit: the
//   nearest one, by a headlight (Surfaces.h) on the level set (litShare). ShellsLayer says what brightness
//   is; z' is taken at the crossing, its depth held within the ramp.
//
// What crop box, clip planes and near distance cut open is closed by caps: where a ray gets in or out by a
// cut, the field (volume/Sampling.h) is read, and the shells whose levels it has reached are met there. Tools
// stand among the shells: an opaque one ends the ray, and with Max whatever lies before it replaces it, or,
// by SurfaceBlend::Max, is seen where it is brighter; a translucent one multiplies what is behind it by 1 -
// alpha and adds its own colour.
//
// In a picture with lenses (Images::rays, plan/RayIntervals.h) rays that meet none are drawn so, where
// ShellsJob::rays says it. Of the others the crossings of each part of its appearance are taken; where a lens
// face cuts shells open they are capped as above, but not where a tool ends the part or the same shells go
// on. Max and Sum gather over all parts, dimmed by their weights; Lit shells end the light of a part.
//
// Pixels are sampled at their centres in double (Surfaces.h), spread over tiles with parallelFor: the same
// bits for any number of threads. Checks the stop token per tile (Cancelled). OutOfMemory by guarded()
// callers.
#pragma once
#include <array>
#include <limits>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "vernier/base/ConvexRegion.h"
#include "vernier/base/HalfSpace.h"
#include "vernier/native/Surfaces.h"
#include "vernier/plan/Volumetric.h"

namespace vernier::native {

struct Shell {
  double level = 0;                  // modality value
  double phi = 0;                    // its emission
  std::shared_ptr<const Mesh> mesh;  // closed, in patient mm, turned outwards; nullptr: empty
};

struct ShellsJob {
  std::shared_ptr<const Volume> volume;
  std::vector<Shell> shells;  // levels and phi ascend
  ShellsMode mode = ShellsMode::Max;
  CameraPicture camera;
  DepthRamp ramp;
  double beta0 = 0, betaM = 1, a = 0, b = 1, phi0 = 0;
  glm::dvec3 colour{1}, background{0};
  SurfaceBlend surfaceBlend = SurfaceBlend::Replace;
  std::vector<HalfSpace> kept;  // keptRegion: the volume's box, then what cuts
  std::vector<PlacedSurface> tools;
  RaysOfPass rays;                                          // of a picture with lenses: what is drawn of it
  std::vector<std::shared_ptr<const ConvexRegion>> lenses;  // for the light on Lit caps
  // Of each appearance of that picture: it shows the same level sets, and they go on through the lens's face,
  // which cuts nothing open there.
  std::vector<bool> goesOn;

  double brightness(double phi, double depth_mm) const {
    const double z = ramp.at(std::clamp(depth_mm, ramp.near_mm, ramp.far_mm));
    return phi * (beta0 + betaM * (a * z + b));
  }
};
inline constexpr std::size_t kBoxPlanes = 6;  // of ShellsJob::kept

// Depth: of the crossing that is shown; with Sum the mean of all; where none is, or a tool outshines it, of
// an opaque tool.
VERNIER_API Result<void> drawShells(const ShellsJob&, Images&, std::stop_token);

// Whether anything of the volume's box is cut away: by a plane, by the near distance, or since it lies behind
// the eye.
VERNIER_API bool isCut(const ShellsJob&);

// What a pixel's ray has of the shells.
struct ShellRay {
  struct Cap {
    int shell = -1;     // the highest whose level the field has reached; -1: no cap
    double t_mm = 0;    // along the ray
    double cosine = 1;  // between the ray and the cut's normal
  };
  double from_mm = 0, to_mm = 0;  // crossings between these count; empty: from_mm > to_mm
  std::array<Cap, 2> caps;        // at the beginning and at the end
};
VERNIER_API ShellRay shellRay(const ShellsJob&, double x, double y);
// The same for one segment of the pixel's ray, an index into its segments.
VERNIER_API ShellRay shellRay(const ShellsJob&, double x, double y, std::span<const RaySegment>,
                              std::size_t index);

// The tools of one pixel.
struct VERNIER_API ToolsOnRay {
  std::span<const SurfaceHits::Layer> layers;               // translucent ones before the end, nearest first
  double end_mm = std::numeric_limits<double>::infinity();  // where an opaque one ends the ray
  glm::dvec3 endColour{0};

  bool ends() const { return end_mm < std::numeric_limits<double>::infinity(); }
  // What is left of light from behind t, and what the translucent ones before t add themselves.
  double through(double t_mm) const;
  glm::dvec3 own(double t_mm) const;
};
VERNIER_API ToolsOnRay toolsAt(const SurfaceHits&, std::size_t pixel);

// What the shells come to in a pixel, and its colour with tools and background.
struct ShellPixel {
  bool hit = false;
  double value = 0;  // brightness, dimmed by tools; Lit: the share of the headlight
  double t_mm = 0;   // where; Sum: the mean of all crossings
};
VERNIER_API glm::dvec3 shellColour(const ShellsJob&, const ShellPixel&, const ToolsOnRay&);
// Of what is seen there: the crossing, or the tool that ends the ray; infinite where there is neither.
VERNIER_API double shownAt_mm(const ShellsJob&, const ShellPixel&, const ToolsOnRay&);

// Lit: the share of the headlight where a ray through pixel coordinates (x, y) meets the mesh of a shell at
// t_mm. By the gradient of the trilinear field where the ray passes the shell's level, at the nearest such
// place within kLitReach_vox; a ray that does not pass it there (at the volume's border, beside no-data)
// keeps `flat`, the share by the triangle's own normal.
inline constexpr double kLitReach_vox = 1.5;
VERNIER_API double litShare(const ShellsJob&, std::size_t shell, double x, double y, double t_mm,
                            double flat);

}  // namespace vernier::native
