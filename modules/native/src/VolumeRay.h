// SPDX-License-Identifier: GPL-3.0-or-later
// What the ways of rendering a volume share: light along a ray, and its steps.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "BrickMarks.h"
#include "Lighting.h"
#include "ProjectionRay.h"
#include "vernier/native/VolumeRender.h"

namespace vernier::native {

// Front to back along one ray.
struct RayLight {
  glm::dvec3 colour{0};
  double through = 1;
  double half_mm = std::numeric_limits<double>::infinity();  // where the accumulated opacity passes 0.5

  // Adds what has the opacity `opacity` and the colour `premultiplied`, evenly spread over [from, to].
  void add(const glm::dvec3& premultiplied, double opacity, double from_mm, double to_mm) {
    colour += through * premultiplied;
    const double after = through * (1 - opacity);
    if (through > 0.5 && after <= 0.5) half_mm = halfPlace(through, after, from_mm, to_mm);
    through = after;
  }
  static double halfPlace(double before, double after, double from_mm, double to_mm) {
    if (!(after > 0)) return from_mm;
    const double share = std::log(0.5 / before) / std::log(after / before);
    return from_mm + std::clamp(share, 0.0, 1.0) * (to_mm - from_mm);
  }
};

// A step's share of a part, and its middle.
struct StepShare {
  double weight = 0, from_mm = 0, to_mm = 0;
};
inline StepShare shareOf(std::int64_t k, double step_mm, double from_mm, double to_mm) {
  const double begin = static_cast<double>(k) * step_mm, end = static_cast<double>(k + 1) * step_mm;
  const double low = std::max(begin, from_mm), high = std::min(end, to_mm);
  return {std::clamp((high - low) / step_mm, 0.0, 1.0), low, high};
}

// Where the marks say that something may be seen; all of it without marks.
struct RayMarks {
  const std::uint64_t* seen = nullptr;
  int words = 0, stepsPerBin = 1;
  std::int64_t firstStep = 0;

  // fn(first step, one beyond the last) within [first, last], until it returns false.
  template <class Fn>
  void eachRun(std::int64_t first, std::int64_t last, Fn&& fn) const {
    if (!seen) {
      fn(first, last + 1);
      return;
    }
    native::eachRun(seen, words, firstStep, stepsPerBin, [&](std::int64_t begin, std::int64_t end) {
      begin = std::max(begin, first), end = std::min(end, last + 1);
      if (begin > last) return false;
      return begin >= end || fn(begin, end);
    });
  }
};

// One part of one ray in double, any job of mode Blend. `direction`: unit, in the patient.
class GeneralBlend {
 public:
  explicit GeneralBlend(const VolumeRenderJob&);
  void along(const VoxelRay&, const glm::dvec3& direction, double from_mm, double to_mm, const RayMarks&,
             RayLight&, ProjectionWork&) const;
  // Steps [begin, end) of a part.
  void steps(const VoxelRay&, const glm::dvec3& direction, double from_mm, double to_mm, std::int64_t begin,
             std::int64_t end, RayLight&, ProjectionWork&) const;

 private:
  template <class T>
  void stepsOf(const VoxelRay&, const glm::dvec3& direction, double from_mm, double to_mm, std::int64_t begin,
               std::int64_t end, RayLight&, ProjectionWork&) const;
  const VolumeRenderJob& job_;
  Lighting lighting_;
  glm::dmat3 patientGradient_;
  glm::dvec3 first_{0}, last_{0};  // the box of voxel centres
};

}  // namespace vernier::native
