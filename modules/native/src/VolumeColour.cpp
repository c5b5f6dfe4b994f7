// SPDX-License-Identifier: GPL-3.0-or-later
#include "VolumeColour.h"

namespace vernier::native {

ColourBlend::ColourBlend(const VolumeRenderJob& job) : job_(job) {
  for (int c = 0; c < job.volume->info().channels; ++c) channels_.emplace_back(job.volume->channel(c));
  const GridGeometry& g = job.volume->grid();
  const glm::dvec3 s = g.spacing_mm();
  lengths_ = job.step_mm / std::min({s.x, s.y, s.z});
  first_ = {0, 0, g.firstPosition_vox()};
  last_ = {static_cast<double>(g.columns - 1), static_cast<double>(g.rows - 1), g.lastPosition_vox()};
}

void ColourBlend::along(const VoxelRay& ray, double from, double to, RayLight& light,
                        ProjectionWork& work) const {
  if (!(to > from)) return;
  const Steps met = stepsOf(from, to, job_.step_mm, false);
  for (std::int64_t k = met.first; k < met.first + met.count && light.through >= job_.leastLight; ++k) {
    const glm::dvec3 p = glm::clamp(ray.at((static_cast<double>(k) + 0.5) * job_.step_mm), first_, last_);
    const auto channel = [&](std::size_t c, std::uint64_t& samples) {
      const double value = channels_[c].value(job_.interpolation, p, samples);
      return std::isnan(value) ? 0.0 : std::clamp(value / 255 * job_.gains[c], 0.0, 1.0);
    };
    std::uint64_t again = 0;
    // Without alpha a voxel is opaque, as far as its gain says.
    const double alpha =
        channels_.size() > 3 ? channel(3, work.samples) : std::clamp(job_.gains[3], 0.0, 1.0);
    if (channels_.size() < 4) ++work.samples;
    if (!(alpha > 0)) continue;
    const double whole = job_.opacity == OpacityRule::Linear ? opacityOverLinear(alpha, lengths_)
                                                             : opacityOver(alpha, lengths_);
    const StepShare share = shareOf(k, job_.step_mm, from, to);
    const double opacity = share.weight < 1 ? opacityOver(whole, share.weight) : whole;
    light.add(opacity * glm::dvec3(channel(0, again), channel(1, again), channel(2, again)), opacity,
              share.from_mm, share.to_mm);
  }
}

}  // namespace vernier::native
