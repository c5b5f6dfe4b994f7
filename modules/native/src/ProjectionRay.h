// SPDX-License-Identifier: GPL-3.0-or-later
// What the projection kernels share: a ray in voxels, and what they do along it.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "vernier/native/Projection.h"
#include "vernier/volume/Voi.h"

namespace vernier::native {

// Voxel positions origin + t * direction, t in mm from the lattice's origin.
struct VoxelRay {
  glm::dvec3 origin{0}, direction{0};
  double rayPerDepth = 1;
  glm::dvec3 at(double t_mm) const { return origin + t_mm * direction; }
};

struct ProjectionWork {
  std::uint64_t samples = 0, cells = 0;
};

// What kernels do with the field along a part.
enum class Gather { Extreme, Cued, Emission, Mean };
inline Gather gatherOf(const ProjectionJob& job) {
  switch (job.mode) {
    case ProjectionMode::Sum:
    case ProjectionMode::Attenuation:
      return Gather::Emission;
    case ProjectionMode::Mean:
      return Gather::Mean;
    default:
      return job.cue > 0 ? Gather::Cued : Gather::Extreme;
  }
}

// The share that the depth cue leaves at a distance along a ray: c0 + c1 t + c2 / t. Falls with t.
struct CueAlong {
  double c0 = 1, c1 = 0, c2 = 0;
  // What lies before the ramp's near end has all of it.
  double at(double t_mm) const { return std::min(1.0, c0 + c1 * t_mm + (c2 != 0 ? c2 / t_mm : 0)); }
};
inline CueAlong cueAlong(const ProjectionJob& job, const VoxelRay& ray) {
  const double range = job.ramp.far_mm - job.ramp.near_mm;
  if (job.ramp.afterProjection)
    return {1 - job.cue - job.cue * job.ramp.near_mm / range, 0,
            job.cue * job.ramp.near_mm * job.ramp.far_mm / range * ray.rayPerDepth};
  return {1 - job.cue + job.cue * job.ramp.far_mm / range, -job.cue / (range * ray.rayPerDepth), 0};
}

// Kernels keep what neighbouring rays share: where the last extremum lay.
struct RayHint {
  double at_mm = -1;
};

// Samples in double with every rule of the grid.
Gathered gatherGeneral(const ProjectionJob&, const VoxelRay&, const RayStretch&, ProjectionWork&);
// Cell by cell; `start`: an extremum that is known to be reached, from a sampled pass (NaN: none).
Gathered gatherExact(const ProjectionJob&, const VoxelRay&, double from_mm, double to_mm,
                     const Gathered& start, ProjectionWork&);

}  // namespace vernier::native
