// SPDX-License-Identifier: GPL-3.0-or-later
#include "GlRayImages.h"

#include <algorithm>
#include <cmath>

#include "vernier/base/Threads.h"

namespace vernier::dvr {
namespace {

// Less than this share of light is left: no more parts of the ray are drawn.
constexpr float kNothingLeft = 1.0f / 4096;
constexpr std::size_t kGrain = 16;  // rows

}  // namespace

bool RayImages::any() const {
  return std::any_of(stepsInRow.begin(), stepsInRow.end(), [](std::uint64_t n) { return n > 0; });
}

std::uint64_t RayImages::samples(bool cutSteps) const {
  double sum = 0;
  for (std::size_t p = 0; p < lattice.size(); p += 4) {
    const double steps = static_cast<double>(lattice[p + 2]);
    if (steps == 0) continue;
    sum += steps;
    if (cutSteps) continue;
    const double first = static_cast<double>(lattice[p]), length = static_cast<double>(length_steps[p / 4]);
    sum -= (first < 0 ? 1 : 0) + (steps > 1 && first + steps - 1 > length ? 1 : 0);
  }
  return static_cast<std::uint64_t>(sum);
}

Result<RayParts> RayParts::make(const GlVolumeJob& job, bool planar, std::stop_token stop,
                                const RayIntervals* lensed) {
  RayParts parts(job, planar);
  const auto width = static_cast<std::size_t>(job.camera.width_px),
             height = static_cast<std::size_t>(job.camera.height_px);
  if (!job.tools.empty()) {
    Result<native::SurfaceHits> found = native::findSurfaces({job.tools, job.camera, glm::dvec3(0)}, stop);
    if (!found) return found.error();
    parts.counters_.triangles += found->counters.triangles;
    parts.hits_ = std::move(*found);
  }
  parts.spans_.resize(width * height);
  parallelFor(height, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const double px = static_cast<double>(x) + 0.5, py = static_cast<double>(y) + 0.5;
        RaySpan& span = parts.spans_[x + width * y];
        if (lensed && lensed->meetsLens(x + width * y)) continue;
        span =
            spanOf(job.camera.ray(px, py), job.region, job.camera.near_mm * job.camera.rayPerDepth(px, py));
        span.exit_mm = std::min(span.exit_mm, parts.tools(x + width * y).end_mm);
      }
  });
  for (std::size_t p = 0; p < parts.spans_.size(); ++p)
    if (!parts.spans_[p].empty()) parts.count_ = std::max(parts.count_, parts.tools(p).layers.size() + 1);
  return parts;
}

native::ToolsOnRay RayParts::tools(std::size_t pixel) const {
  return hits_ ? native::toolsAt(*hits_, pixel) : native::ToolsOnRay{};
}

RaySpan RayParts::span(std::size_t pixel, std::size_t n) const {
  const RaySpan whole = spans_[pixel];
  if (whole.empty()) return whole;
  const native::ToolsOnRay tools = this->tools(pixel);
  if (n > tools.layers.size()) return {};
  const auto cut = [&](std::size_t layer) {
    return std::clamp(static_cast<double>(tools.layers[layer].t_mm), whole.entry_mm, whole.exit_mm);
  };
  const RaySpan part{n == 0 ? whole.entry_mm : cut(n - 1), n == tools.layers.size() ? whole.exit_mm : cut(n)};
  // Parts without length hold nothing, but of a ray that only touches the volume.
  return part.entry_mm < part.exit_mm || tools.layers.empty() ? part : RaySpan{};
}

RayImages RayParts::images(std::size_t n, const std::vector<float>& through) const {
  return rayImages(
      *job_, planar_, [&](std::size_t p) { return span(p, n); },
      [&](std::size_t p) { return through.empty() ? 1.0f : through[p]; });
}

RayImages rayImages(const GlVolumeJob& job, bool planar, const std::function<RaySpan(std::size_t)>& spanOf,
                    const std::function<float(std::size_t)>& leftOf) {
  const auto width = static_cast<std::size_t>(job.camera.width_px),
             height = static_cast<std::size_t>(job.camera.height_px);
  RayImages out;
  out.start.assign(4 * width * height, 0.0f), out.lattice.assign(4 * width * height, 0.0f);
  out.entry_mm.assign(width * height, 0.0), out.length_steps.assign(width * height, 0.0f),
      out.stepsInRow.assign(height, 0);
  const VoxelFromPatient& toVoxel = job.volume->voxelFromPatient();
  parallelFor(height, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t p = x + width * y;
        const RaySpan part = spanOf(p);
        const float left = leftOf(p);
        if (part.empty() || left < kNothingLeft) continue;
        const double px = static_cast<double>(x) + 0.5, py = static_cast<double>(y) + 0.5;
        const double d = job.step_mm * (planar ? job.camera.rayPerDepth(px, py) : 1.0);
        const glm::dvec3 from = (toVoxel * job.camera.ray(px, py).at(part.entry_mm)).p;
        const double first = std::floor(part.entry_mm / d);
        const double steps = std::max(1.0, std::ceil(part.exit_mm / d) - first);
        float* const start = out.start.data() + 4 * p;
        for (int axis = 0; axis < 3; ++axis) start[axis] = static_cast<float>(from[axis]);
        start[3] = static_cast<float>(part.exit_mm - part.entry_mm);
        float* const lattice = out.lattice.data() + 4 * p;
        lattice[0] = static_cast<float>(first + 0.5 - part.entry_mm / d);
        lattice[1] = static_cast<float>(first), lattice[2] = static_cast<float>(steps), lattice[3] = left;
        out.entry_mm[p] = part.entry_mm;
        out.length_steps[p] = static_cast<float>((part.exit_mm - part.entry_mm) / d);
        out.stepsInRow[y] += static_cast<std::uint64_t>(steps);
      }
  });
  return out;
}

}  // namespace vernier::dvr
