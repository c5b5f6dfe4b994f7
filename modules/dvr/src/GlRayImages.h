// SPDX-License-Identifier: GPL-3.0-or-later
// Where each pixel's ray runs, found in double on the CPU, as images for the shaders: between box, crop, clip
// planes, near distance and tools. Translucent tools cut a ray into parts, which are drawn one after the
// other and joined with the tools between them. Everything that a shader counts from the ray's entry stays
// small, so that floats hold it.
#pragma once
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "GlVolumeJob.h"
#include "vernier/native/Shells.h"

namespace vernier::dvr {

// One part of every ray. Pixels that have none: 0 steps.
struct RayImages {
  std::vector<float> start;    // voxel position where the part begins, its length in mm
  std::vector<float> lattice;  // first sample in steps from there (-1/2 .. 1/2), its number on the lattice,
                               // steps, what earlier parts let through
  std::vector<float> length_steps;        // of the part
  std::vector<double> entry_mm;           // along the ray, where the part begins
  std::vector<std::uint64_t> stepsInRow;  // sums, for bounded batches
  bool any() const;
  // Of the lattice, on all rays; `cutSteps`: those too whose sample lies beyond an end of its ray.
  std::uint64_t samples(bool cutSteps) const;
};

// `spanOf`: of each pixel, mm along its ray; empty: it has no part. `left`: what earlier parts let through.
RayImages rayImages(const GlVolumeJob&, bool planar, const std::function<RaySpan(std::size_t)>& spanOf,
                    const std::function<float(std::size_t)>& left);

class RayParts {
 public:
  // `planar`: the lattice counts depth along the view instead of distance along the ray.
  // `lensed`: rays that meet a lens there have no parts.
  static Result<RayParts> make(const GlVolumeJob&, bool planar, std::stop_token,
                               const RayIntervals* lensed = nullptr);

  // Parts of the ray with the most of them.
  std::size_t count() const { return count_; }
  // Part n of all rays, `through` what is left before it (empty: all); rays without light left have none.
  RayImages images(std::size_t n, const std::vector<float>& through) const;
  RaySpan span(std::size_t pixel, std::size_t n) const;  // empty: no such part
  native::ToolsOnRay tools(std::size_t pixel) const;
  const Counters& counters() const { return counters_; }

 private:
  RayParts(const GlVolumeJob& job, bool planar) : job_(&job), planar_(planar) {}
  const GlVolumeJob* job_;
  bool planar_;
  std::size_t count_ = 1;
  std::vector<RaySpan> spans_;  // whole, up to an opaque tool
  std::optional<native::SurfaceHits> hits_;
  Counters counters_;
};

}  // namespace vernier::dvr
