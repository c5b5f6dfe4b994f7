// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "GeneralSampler.h"
#include "ProjectionRay.h"

namespace vernier::native {
namespace {

// One sample of the lattice and the mm that it stands for.
struct Sample {
  double t = 0, weight = 0;
};

Sample sampleOf(std::int64_t step, double step_mm, const RayStretch& s, bool extreme) {
  const double begin = static_cast<double>(step) * step_mm, end = static_cast<double>(step + 1) * step_mm;
  const double least = s.least_mm(), most = s.most_mm();
  if (extreme) return {std::clamp(0.5 * (begin + end), least, most), step_mm};
  return {0.5 * (std::max(begin, least) + std::min(end, most)),
          std::max(0.0, std::min(end, s.to_mm) - std::max(begin, s.from_mm))};
}

template <class T>
Gathered gather(const ProjectionJob& job, const VoxelRay& ray, const RayStretch& part, ProjectionWork& work) {
  const GeneralSampler<T> sampler(*job.volume);
  const Gather how = gatherOf(job);
  const bool extreme = how == Gather::Extreme || how == Gather::Cued;
  const double sign = job.mode == ProjectionMode::Min ? -1 : 1;
  const CueAlong cue = how == Gather::Cued ? cueAlong(job, ray) : CueAlong{};
  const Steps steps = stepsOf(part, job.step_mm, extreme);
  double best = -std::numeric_limits<double>::infinity();
  Gathered out;
  for (std::int64_t n = 0; n < steps.count; ++n) {
    const Sample s = sampleOf(steps.first + n, job.step_mm, part, extreme);
    const double value = sampler.value(job.interpolation, ray.at(s.t), work.samples);
    if (std::isnan(value)) continue;
    if (extreme) {
      const double score = how == Gather::Cued ? applyVoi(job.window, value) * cue.at(s.t) : sign * value;
      if (score > best) best = score, out.best = how == Gather::Cued ? score : value, out.at_mm = s.t;
    } else {
      out.integral += s.weight * (how == Gather::Emission ? applyVoi(job.window, value) : value);
    }
    out.length_mm += s.weight;
  }
  return out;
}

}  // namespace

Gathered gatherGeneral(const ProjectionJob& job, const VoxelRay& ray, const RayStretch& part,
                       ProjectionWork& work) {
  switch (job.volume->type()) {
    case VoxelType::U8:
      return gather<std::uint8_t>(job, ray, part, work);
    case VoxelType::I8:
      return gather<std::int8_t>(job, ray, part, work);
    case VoxelType::U16:
      return gather<std::uint16_t>(job, ray, part, work);
    case VoxelType::I16:
      return gather<std::int16_t>(job, ray, part, work);
    case VoxelType::U32:
      return gather<std::uint32_t>(job, ray, part, work);
    case VoxelType::I32:
      return gather<std::int32_t>(job, ray, part, work);
    case VoxelType::F32:
      break;
  }
  return gather<float>(job, ray, part, work);
}

}  // namespace vernier::native
