// SPDX-License-Identifier: GPL-3.0-or-later
#include "VolumeExtreme.h"

#include <cmath>
#include <limits>

#include "Lighting.h"
#include "vernier/base/Threads.h"

namespace vernier::native {
namespace {

ProjectionJob projectionOf(const VolumeRenderJob& job, const Volume& volume) {
  ProjectionJob p;
  p.volume = &volume;
  p.camera = job.camera, p.region = job.region, p.background = job.background;
  p.mode = job.mode == VolumeMode::Max ? ProjectionMode::Max : ProjectionMode::Min;
  p.interpolation = job.interpolation;
  p.step_mm = job.step_mm;
  p.exact = job.exact && whyNotExact(p).empty();
  return p;
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

// Each channel is a projection of its own, with the gain as its window.
Result<void> renderColours(const VolumeRenderJob& job, Images& images, std::stop_token stop) {
  for (int c = 0; c < 3; ++c) {
    ProjectionJob p = projectionOf(job, job.volume->channel(c));
    const double white = 255 / std::max(job.gains[static_cast<std::size_t>(c)], 1e-12);
    p.window = normalised({0.5 * white, white, VoiFunction::LinearExact, ""});
    p.tools = job.tools;
    Images one;
    if (Result<void> drawn = drawProjection(p, one, stop); !drawn) return drawn;
    images.counters += one.counters;
    for (std::size_t n = 0; n < images.depth.size(); ++n) {
      images.colour[4 * n + static_cast<std::size_t>(c)] = one.colour[4 * n + static_cast<std::size_t>(c)];
      images.colour[4 * n + 3] = 1;
    }
    if (c == 0) images.depth = one.depth;
  }
  return {};
}

Result<void> renderGrey(const VolumeRenderJob& job, Images& images, std::stop_token stop) {
  ProjectionJob p = projectionOf(job, *job.volume);
  p.bounds = job.bounds;
  p.window = normalised(wholeRange(*job.volume));
  SurfaceHits ends;
  if (job.tools) ends = endsOf(*job.tools), p.tools = &ends;
  Images found;
  found.values.resize(images.depth.size());
  if (Result<void> drawn = drawProjection(p, found, stop); !drawn) return drawn;
  images.counters += found.counters;
  eachPixel(images.depth.size(), [&](std::size_t n) {
    Seen seen;
    const bool data = !std::isnan(found.values[n]);
    if (data) {
      const double value = static_cast<double>(found.values[n]);
      seen.t_mm = static_cast<double>(found.depth[n]);
      seen.colour = colourAt(*job.function, value), seen.opacity = opacityAt(*job.function, value);
    }
    put(job, n, seen, data, images);
  });
  if (!images.values.empty()) images.values = std::move(found.values);
  return {};
}

}  // namespace

Result<void> renderExtreme(const VolumeRenderJob& job, Images& images, std::stop_token stop) {
  images.width = job.camera.width_px, images.height = job.camera.height_px;
  const std::size_t count = static_cast<std::size_t>(images.width) * static_cast<std::size_t>(images.height);
  images.colour.resize(4 * count), images.depth.resize(count);
  return job.volume->isColour() ? renderColours(job, images, stop) : renderGrey(job, images, stop);
}

}  // namespace vernier::native
