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

ProjectionReference::Gathered ProjectionReference::nothing(const VolumeRay& ray) {
  Gathered none;
  none.emission_mm.assign(ray.tools.size() + 1, 0);
  return none;
}

void ProjectionReference::gather(const VolumeRay& ray, Gathered& all) const {
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
}

double ProjectionReference::amount(const VolumeRay& ray, const Gathered& all) const {
  switch (layer_.mode) {
    case ProjectionMode::Max:
      return all.brightest;
    case ProjectionMode::Min:
      return all.darkest;
    case ProjectionMode::Mean:
      return windowGrey(rays_.window(), all.integral / all.length_mm) * all.seenLength_mm / all.length_mm;
    case ProjectionMode::Sum:
    case ProjectionMode::Attenuation:
      break;
  }
  const bool attenuation = layer_.mode == ProjectionMode::Attenuation;
  double sum = 0;
  for (std::size_t n = 0; n < all.emission_mm.size(); ++n)
    sum += (attenuation ? 1 : ray.through[n]) * gain_perMm_ * all.emission_mm[n];
  return attenuation ? std::exp(-sum) : sum;
}

std::vector<double> ProjectionReference::reaching(const Gathered& all) const {
  std::vector<double> out;
  double sum = 0;
  for (std::size_t n = 0; n + 1 < all.emission_mm.size(); ++n) {
    if (layer_.mode == ProjectionMode::Attenuation) sum += gain_perMm_ * all.emission_mm[n];
    out.push_back(std::exp(-sum));
  }
  return out;
}

glm::dvec3 ProjectionReference::combined(const VolumeRay& ray, const Gathered& all) const {
  const bool attenuation = layer_.mode == ProjectionMode::Attenuation;
  const std::vector<double> reaching = this->reaching(all);
  glm::dvec3 tools(0);
  for (std::size_t n = 0; n < ray.tools.size(); ++n)
    tools += reaching[n] * ray.through[n] * ray.tools[n].opacity * ray.tools[n].colour;
  glm::dvec3 otherwise(attenuation ? 1 : 0);
  if (layer_.mode == ProjectionMode::Sum && !invert_) otherwise = background_;
  const glm::dvec3 behind = ray.backdrop(otherwise);
  const double amount = this->amount(ray, all);
  if (layer_.mode == ProjectionMode::Sum) return tools + amount + behind;
  if (attenuation) return tools + amount * behind;
  return tools + glm::max(glm::dvec3(amount), behind);
}

Gathering ProjectionReference::gathered(const VolumeRay& whole, std::span<const VolumeRay> parts) const {
  Gathered all = nothing(whole);
  for (const VolumeRay& part : parts) gather(part, all);
  constexpr Accumulator kinds[] = {Accumulator::Max, Accumulator::Min, Accumulator::Sum, Accumulator::Mean,
                                   Accumulator::Attenuation};
  Gathering g;
  g.accumulator = kinds[static_cast<std::size_t>(layer_.mode)];
  g.covered = all.length_mm > 0;
  if (g.covered) g.value = glm::dvec3(amount(whole, all));
  g.bare = layer_.mode == ProjectionMode::Attenuation ? glm::dvec3(1) : background_;
  if (everywhere()) g.behind = g.bare;
  g.reaching = reaching(all);
  return g;
}

PartMark ProjectionReference::mark(const VolumeRay& part) const {
  PartMark mark;
  rays_.alongData(part, [&](const RayPart&) {
    mark.shown = true;
    return false;
  });
  return mark;
}

VolumeSeen ProjectionReference::seen(glm::dvec2 pixel) const {
  VolumeRay ray = rays_.ray(pixel);
  Gathered all = nothing(ray);
  gather(ray, all);
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
  return VolumeRays::edgeKey(ray, mark(ray).shown);
}

bool ProjectionReference::contributes(const LocalRange& values) const {
  if (values.min > values.max) return false;
  // Without emission a sum is as if nothing were there, and a maximum as black as the background.
  const bool black = layer_.mode == ProjectionMode::Max && !invert_ && background_ == glm::dvec3(0);
  if (!everywhere() && !black) return true;
  return windowGrey(rays_.window(), values.max) > 0;
}

}  // namespace vernier::quality
