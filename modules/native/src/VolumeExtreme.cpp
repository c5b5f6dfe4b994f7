// SPDX-License-Identifier: GPL-3.0-or-later
#include "VolumeExtreme.h"

#include <cmath>
#include <limits>

#include "Lighting.h"
#include "vernier/base/Threads.h"

namespace vernier::native {
namespace {

// The extremes of one grey volume before the tools that end rays.
Result<Images> extremes(const VolumeRenderJob& job, const Volume& volume, const SurfaceHits* ends,
                        std::stop_token stop) {
  ProjectionJob p;
  p.volume = &volume, p.bounds = job.bounds;
  p.camera = job.camera, p.region = job.region;
  p.mode = job.mode == VolumeMode::Max ? ProjectionMode::Max : ProjectionMode::Min;
  p.interpolation = job.interpolation;
  p.window = normalised(wholeRange(volume));
  p.step_mm = job.step_mm, p.tools = ends;
  p.exact = job.exact && whyNotExact(p).empty();
  if (volume.isColour()) p.bounds = nullptr;
  Images images;
  images.values.resize(static_cast<std::size_t>(job.camera.width_px) *
                       static_cast<std::size_t>(job.camera.height_px));
  if (Result<void> drawn = drawProjection(p, images, stop); !drawn) return drawn.error();
  return images;
}

// Only what ends rays: translucent tools weaken colours here, not values.
SurfaceHits endsOf(const SurfaceHits& tools) {
  SurfaceHits out;
  out.width = tools.width, out.height = tools.height;
  out.end_mm = tools.end_mm;
  out.endColour.assign(tools.endColour.size(), -1.0f);  // never brighter than a value
  out.first.assign(tools.first.size(), 0);
  return out;
}

// What a pixel shows of the volume.
struct Seen {
  glm::dvec3 colour{0};
  double opacity = 0, t_mm = std::numeric_limits<double>::infinity();
};

glm::dvec3 withTools(const VolumeRenderJob& job, std::size_t pixel, const Seen& seen) {
  glm::dvec3 sum(0), end = colourOf(job.background);
  double through = 1;
  bool passed = !(seen.opacity > 0);
  const auto pass = [&] {
    sum += through * seen.opacity * seen.colour;
    through *= 1 - seen.opacity;
    passed = true;
  };
  if (const SurfaceHits* tools = job.tools) {
    for (std::uint32_t n = tools->first[pixel]; n < tools->first[pixel + 1]; ++n) {
      const SurfaceHits::Layer& l = tools->layers[n];
      if (!passed && seen.t_mm < static_cast<double>(l.t_mm)) pass();
      sum += through * glm::dvec3(l.r, l.g, l.b);
      through *= 1 - static_cast<double>(l.alpha);
    }
    if (std::isfinite(tools->end_mm[pixel]))
      for (std::size_t c = 0; c < 3; ++c)
        end[static_cast<int>(c)] = static_cast<double>(tools->endColour[3 * pixel + c]);
  }
  if (!passed) pass();
  return sum + through * end;
}

void put(const VolumeRenderJob& job, std::size_t pixel, const Seen& seen, bool data, Images& images) {
  const glm::dvec3 colour = withTools(job, pixel, seen);
  for (int c = 0; c < 3; ++c)
    images.colour[4 * pixel + static_cast<std::size_t>(c)] = static_cast<float>(colour[c]);
  images.colour[4 * pixel + 3] = 1;
  images.depth[pixel] = data        ? static_cast<float>(seen.t_mm)
                        : job.tools ? job.tools->end_mm[pixel]
                                    : kNothing_mm;
}

template <class Fn>
void eachPixel(std::size_t count, Fn&& fn) {
  parallelFor(count, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) fn(n);
  });
}

}  // namespace

Result<void> renderExtreme(const VolumeRenderJob& job, Images& images, std::stop_token stop) {
  const std::size_t count =
      static_cast<std::size_t>(job.camera.width_px) * static_cast<std::size_t>(job.camera.height_px);
  images.width = job.camera.width_px, images.height = job.camera.height_px;
  images.colour.resize(4 * count), images.depth.resize(count);
  SurfaceHits ends;
  if (job.tools) ends = endsOf(*job.tools);
  const int channels = job.volume->isColour() ? 3 : 1;
  std::vector<Images> found;
  for (int c = 0; c < channels; ++c) {
    Result<Images> one = extremes(job, channels == 1 ? *job.volume : job.volume->channel(c),
                                  job.tools ? &ends : nullptr, stop);
    if (!one) return one.error();
    images.counters += one->counters;
    found.push_back(*std::move(one));
  }
  if (channels == 1 && !images.values.empty()) images.values = found[0].values;
  eachPixel(count, [&](std::size_t n) {
    const bool data = !std::isnan(found[0].values[n]);
    Seen seen;
    if (data) {
      seen.t_mm = static_cast<double>(found[0].depth[n]);
      if (channels == 1) {
        const double value = static_cast<double>(found[0].values[n]);
        seen.colour = colourAt(*job.function, value), seen.opacity = opacityAt(*job.function, value);
      } else {
        for (std::size_t c = 0; c < 3; ++c)
          seen.colour[static_cast<int>(c)] =
              std::clamp(static_cast<double>(found[c].values[n]) / 255 * job.gains[c], 0.0, 1.0);
        seen.opacity = 1;
      }
    }
    put(job, n, seen, data, images);
  });
  return {};
}

}  // namespace vernier::native
