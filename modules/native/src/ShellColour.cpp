// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "vernier/native/Shells.h"

namespace vernier::native {

double ToolsOnRay::through(double t_mm) const {
  double left = 1;
  for (const SurfaceHits::Layer& l : layers) {
    if (!(l.t_mm < t_mm)) break;
    left *= 1 - static_cast<double>(l.alpha);
  }
  return left;
}

glm::dvec3 ToolsOnRay::own(double t_mm) const {
  glm::dvec3 sum(0);
  double left = 1;
  for (const SurfaceHits::Layer& l : layers) {
    if (!(l.t_mm < t_mm)) break;
    sum += left * glm::dvec3(l.r, l.g, l.b);
    left *= 1 - static_cast<double>(l.alpha);
  }
  return sum;
}

ToolsOnRay toolsAt(const SurfaceHits& hits, std::size_t pixel) {
  ToolsOnRay out;
  out.layers = std::span(hits.layers).subspan(hits.first[pixel], hits.first[pixel + 1] - hits.first[pixel]);
  if (hits.end_mm[pixel] == kNothing_mm) return out;
  out.end_mm = static_cast<double>(hits.end_mm[pixel]);
  for (std::size_t c = 0; c < 3; ++c)
    out.endColour[static_cast<int>(c)] = static_cast<double>(hits.endColour[3 * pixel + c]);
  return out;
}

glm::dvec3 shellColour(const ShellsJob& job, const ShellPixel& pixel, const ToolsOnRay& tools) {
  const glm::dvec3 shells = job.colour * pixel.value;
  if (job.mode == ShellsMode::Lit && pixel.hit)
    return tools.own(pixel.t_mm) + tools.through(pixel.t_mm) * shells;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const glm::dvec3 own = tools.own(kFar), least = job.colour * (job.beta0 * job.phi0);
  const double through = tools.through(kFar);
  if (job.mode == ShellsMode::Sum && pixel.hit)
    return own + shells + (tools.ends() ? through * tools.endColour : glm::dvec3(0));
  if (tools.ends()) {
    const glm::dvec3 tool = through * tools.endColour;
    const bool replace = job.mode != ShellsMode::Max || job.surfaceBlend == SurfaceBlend::Replace;
    return own + (!pixel.hit ? tool : replace ? shells : glm::max(shells, tool));
  }
  if (job.mode != ShellsMode::Max) return own + through * job.background;
  return own + (pixel.hit ? glm::max(shells, through * least) : through * glm::max(least, job.background));
}

double shownAt_mm(const ShellsJob& job, const ShellPixel& pixel, const ToolsOnRay& tools) {
  if (!pixel.hit) return tools.end_mm;
  if (job.mode != ShellsMode::Max || job.surfaceBlend == SurfaceBlend::Replace || !tools.ends())
    return pixel.t_mm;
  const glm::dvec3 tool = tools.through(std::numeric_limits<double>::infinity()) * tools.endColour;
  return glm::all(glm::lessThan(job.colour * pixel.value, tool)) ? tools.end_mm : pixel.t_mm;
}

}  // namespace vernier::native
