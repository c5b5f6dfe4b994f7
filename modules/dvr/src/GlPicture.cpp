// SPDX-License-Identifier: GPL-3.0-or-later
// From the parts of the rays to the picture, in double.
#include <algorithm>
#include <limits>

#include "GlDrawing.h"

namespace vernier::dvr {
namespace {
constexpr double kHalf = 0.5;  // of the light is left: there lies what is pointed at
}

PictureMaker::PictureMaker(const GlVolumeJob& job, const RayParts& parts) : job_(job), parts_(parts) {
  const std::size_t n =
      static_cast<std::size_t>(job.camera.width_px) * static_cast<std::size_t>(job.camera.height_px);
  through_.assign(n, 1.0f), colour_.assign(n, glm::dvec3(0)), depth_.assign(n, kNothing_mm);
  values_.assign(n, std::numeric_limits<float>::quiet_NaN()), covered_.assign(n, false);
}

void PictureMaker::takeExtreme(std::size_t p, const RayImages& rays, const DrawnPart& drawn) {
  const float* const found = drawn.found.data() + 4 * p;
  if (found[0] < 0) return;
  depth_[p] = static_cast<float>(rays.entry_mm[p] + static_cast<double>(found[0]));
  if (job_.volume->isColour()) {
    for (int c = 0; c < 3; ++c)
      colour_[p][c] = static_cast<double>(drawn.seen[4 * p + static_cast<std::size_t>(c)]);
    covered_[p] = true;
    return;
  }
  const double value = job_.code.slope * static_cast<double>(found[2]) + job_.code.modalityAtBias;
  const double opacity = opacityAt(job_.transfer, value);
  values_[p] = static_cast<float>(value);
  colour_[p] = opacity * colourAt(job_.transfer, value);
  through_[p] = static_cast<float>(1 - opacity);
}

void PictureMaker::take(std::size_t n, const RayImages& rays, const DrawnPart& drawn) {
  samples_ += drawn.samples;
  for (std::size_t p = 0; p < through_.size(); ++p) {
    const native::ToolsOnRay tools = parts_.tools(p);
    if (rays.lattice[4 * p + 2] > 0) {
      samples_ += static_cast<std::uint64_t>(drawn.found[4 * p + 1]);
      cells_ += static_cast<std::uint64_t>(drawn.found[4 * p + 3]);
      if (job_.extreme()) {
        takeExtreme(p, rays, drawn);
      } else {
        const float* const seen = drawn.seen.data() + 4 * p;
        const double before = static_cast<double>(through_[p]);
        colour_[p] += before * glm::dvec3(seen[0], seen[1], seen[2]);
        through_[p] = static_cast<float>(before * static_cast<double>(seen[3]));
        if (depth_[p] == kNothing_mm && drawn.found[4 * p] >= 0) {
          depth_[p] = static_cast<float>(rays.entry_mm[p] + static_cast<double>(drawn.found[4 * p]));
          if (job_.iso) values_[p] = static_cast<float>(job_.level);
        }
      }
    }
    if (n >= tools.layers.size()) continue;
    const native::SurfaceHits::Layer& layer = tools.layers[n];
    const double before = static_cast<double>(through_[p]);
    colour_[p] += before * glm::dvec3(layer.r, layer.g, layer.b);
    through_[p] = static_cast<float>(before * (1 - static_cast<double>(layer.alpha)));
    if (depth_[p] == kNothing_mm && static_cast<double>(through_[p]) <= kHalf) depth_[p] = layer.t_mm;
  }
}

void PictureMaker::finish(Images& images) {
  if (images.colour.size() != 4 * through_.size())
    images.allocate(job_.camera.width_px, job_.camera.height_px, job_.wantValues);
  for (std::size_t p = 0; p < through_.size(); ++p) {
    if (images.rays && images.rays->meetsLens(p)) continue;
    const native::ToolsOnRay tools = parts_.tools(p);
    const glm::dvec3 behind = tools.ends() ? tools.endColour : job_.background;
    const glm::dvec3 c = colour_[p] + (covered_[p] ? 0.0 : static_cast<double>(through_[p])) * behind;
    for (int n = 0; n < 3; ++n) images.colour[4 * p + static_cast<std::size_t>(n)] = static_cast<float>(c[n]);
    images.colour[4 * p + 3] = 1;
    images.depth[p] = depth_[p] == kNothing_mm && tools.ends() ? static_cast<float>(tools.end_mm) : depth_[p];
    if (!images.values.empty()) images.values[p] = values_[p];
  }
  images.counters.samples += samples_;
  images.counters.cells += cells_;
  images.counters.triangles += parts_.counters().triangles;
}

}  // namespace vernier::dvr
