// SPDX-License-Identifier: GPL-3.0-or-later
#include "ProjectionReference.h"

#include <cmath>

#include "Grey.h"

namespace vernier::quality {

Result<ProjectionReference> ProjectionReference::make(const Scene& scene, const ProjectionLayer& layer,
                                                      const View& view, const Sources& sources) {
  auto rays = VolumeRays::make(scene, layer.source, layer.interpolation, layer.window, view, sources);
  if (!rays) return rays.error();
  if (!(layer.cue >= 0 && layer.cue <= 1))
    return makeError(ErrorCode::SceneInvalid, "The depth cue lies between 0 and 1.");
  ProjectionReference r(std::move(*rays), layer);
  r.background_ = {scene.background.r, scene.background.g, scene.background.b};
  r.gain_perMm_ = layer.gain_perMm.value_or(4 / r.rays_.diagonal_mm());
  if (!(r.gain_perMm_ > 0) || !std::isfinite(r.gain_perMm_))
    return makeError(ErrorCode::SceneInvalid, "The gain must be a number above 0.");
  r.invert_ = layer.invert != r.rays_.volume().info().inverted;
  return r;
}

ProjectionReference::Gathered ProjectionReference::gather(const VolumeRay& ray) const {
  Gathered all;
  all.emission_mm.assign(ray.tools.size() + 1, 0);
  const VoiWindow& window = rays_.window();
  rays_.alongData(ray, [&](const RayPart& part) {
    const double through = ray.through[part.passed], length = part.length_mm();
    all.length_mm += length;
    all.seenLength_mm += through * length;
    switch (layer_.mode) {
      case ProjectionMode::Max: {
        const LocalRange e = part.piece.extremes();
        all.values.add(e.max);
        const Cue cue = rays_.cue(ray, part, 1 - layer_.cue, layer_.cue);
        if (through > 0)
          all.brightest =
              std::max(all.brightest, through * brightest(part.piece, window, cue, all.brightest / through));
        break;
      }
      case ProjectionMode::Min: {
        const LocalRange e = part.piece.extremes();
        all.values.add(e.min);
        all.darkest = std::min(all.darkest, through * windowGrey(window, e.min));
        break;
      }
      case ProjectionMode::Mean:
        all.integral += length * part.piece.mean();
        break;
      case ProjectionMode::Sum:
      case ProjectionMode::Attenuation:
        all.emission_mm[part.passed] += length * meanGrey(part.piece, window);
        break;
    }
    return true;
  });
  return all;
}

glm::dvec3 ProjectionReference::combined(const VolumeRay& ray, const Gathered& all) const {
  glm::dvec3 tools(0);
  double sum = 0;  // Sum: of what tools leave of the emission; Attenuation: of the absorption so far
  const bool attenuation = layer_.mode == ProjectionMode::Attenuation;
  for (std::size_t n = 0; n <= ray.tools.size(); ++n) {
    const double here = gain_perMm_ * all.emission_mm[n];
    sum += attenuation ? here : ray.through[n] * here;
    if (n == ray.tools.size()) break;
    const double reaching = attenuation ? std::exp(-sum) : 1;
    tools += reaching * ray.through[n] * ray.tools[n].opacity * ray.tools[n].colour;
  }
  glm::dvec3 otherwise(attenuation ? 1 : 0);
  if (layer_.mode == ProjectionMode::Sum && !invert_) otherwise = background_;
  const glm::dvec3 behind = ray.backdrop(otherwise);
  switch (layer_.mode) {
    case ProjectionMode::Max:
      return tools + glm::max(glm::dvec3(all.brightest), behind);
    case ProjectionMode::Min:
      return tools + glm::max(glm::dvec3(all.darkest), behind);
    case ProjectionMode::Mean: {
      const double grey = windowGrey(rays_.window(), all.integral / all.length_mm);
      return tools + glm::max(glm::dvec3(grey * all.seenLength_mm / all.length_mm), behind);
    }
    case ProjectionMode::Sum:
      return tools + sum + behind;
    case ProjectionMode::Attenuation:
      break;
  }
  return tools + std::exp(-sum) * behind;
}

VolumeSeen ProjectionReference::seen(glm::dvec2 pixel) const {
  VolumeRay ray = rays_.ray(pixel);
  const Gathered all = gather(ray);
  VolumeSeen out;
  out.shown = all.length_mm > 0;
  out.covered = out.shown || ray.opaque || !ray.tools.empty();
  if (!out.shown && !everywhere()) {
    out.colour = ray.backdrop(background_);
    for (std::size_t n = 0; n < ray.tools.size(); ++n)
      out.colour += ray.through[n] * ray.tools[n].opacity * ray.tools[n].colour;
    return out;
  }
  if (invert_) {
    for (RayTool& tool : ray.tools) tool.colour = 1.0 - tool.colour;
    if (ray.opaque) ray.opaque->colour = 1.0 - ray.opaque->colour;
  }
  out.colour = combined(ray, all);
  if (invert_) out.colour = 1.0 - glm::clamp(out.colour, 0.0, 1.0);
  if (layer_.mode == ProjectionMode::Max) out.value = all.values.max;
  if (layer_.mode == ProjectionMode::Min) out.value = all.values.min;
  if (layer_.mode == ProjectionMode::Mean) out.value = all.integral / all.length_mm;
  return out;
}

std::uint64_t ProjectionReference::edgeKey(glm::dvec2 pixel) const {
  const VolumeRay ray = rays_.ray(pixel);
  bool shown = false;
  rays_.alongData(ray, [&](const RayPart&) {
    shown = true;
    return false;
  });
  return VolumeRays::edgeKey(ray, shown);
}

bool ProjectionReference::contributes(const LocalRange& values) const {
  if (values.min > values.max) return false;
  // Without emission a sum is as if nothing were there, and a maximum as black as the background.
  const bool black = layer_.mode == ProjectionMode::Max && !invert_ && background_ == glm::dvec3(0);
  if (!everywhere() && !black) return true;
  return windowGrey(rays_.window(), values.max) > 0;
}

}  // namespace vernier::quality
