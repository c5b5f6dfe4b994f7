// SPDX-License-Identifier: GPL-3.0-or-later
#include "ShellsReference.h"

#include <cmath>

#include "Grey.h"
#include "vernier/plan/Volumetric.h"

namespace vernier::quality {
namespace {

// Data that end and begin again within less than this (mm) do not end.
constexpr double kJoint_mm = 1e-9;

}  // namespace

Result<ShellsReference> ShellsReference::make(const Scene& scene, const ShellsLayer& layer, const View& view,
                                              const Sources& sources) {
  auto rays = VolumeRays::make(scene, layer.source, Interpolation::Linear, layer.window, view, sources);
  if (!rays) return rays.error();
  if (layer.cueByDistance) rays->cueByDistance();
  for (double x : {layer.beta0, layer.betaM, layer.a, layer.b, layer.phi0})
    if (!(x >= 0) || !std::isfinite(x))
      return makeError(ErrorCode::SceneInvalid,
                       "The numbers of a shells layer's brightness are finite and not below 0.");
  ShellsReference r(std::move(*rays), layer);
  ShellsLayer windowed = layer;
  windowed.window = r.rays_.window();
  const auto levels = shellLevels(windowed, r.rays_.volume());
  if (!levels) return levels.error();
  for (std::size_t n = 0; n < levels->size(); ++n)
    if (std::find(layer.disabled.begin(), layer.disabled.end(), static_cast<int>(n)) ==
        layer.disabled.end()) {
      r.levels_.push_back((*levels)[n]);
      r.phi_.push_back(windowGrey(r.rays_.window(), (*levels)[n]));
    }
  r.background_ = {scene.background.r, scene.background.g, scene.background.b};
  r.colour_ = {layer.colour.r, layer.colour.g, layer.colour.b};
  return r;
}

template <class Fn>
void ShellsReference::crossings(const VolumeRay& ray, Fn&& fn) const {
  const auto reached = [&](double value) {
    return static_cast<std::size_t>(std::upper_bound(levels_.begin(), levels_.end(), value) -
                                    levels_.begin());
  };
  std::size_t inside = 0;  // levels that the value has reached
  double end_mm = -1;      // of the data so far
  double cell_mm = 0;
  std::size_t passed = 0;
  bool going = true;
  const auto change = [&](std::size_t to, auto&& crossingOf) {
    while (going && inside != to) {
      const std::size_t level = to > inside ? inside : inside - 1;
      going = fn(crossingOf(level));
      to > inside ? ++inside : --inside;
    }
  };
  const auto leave = [&] {
    change(0, [&](std::size_t level) { return Crossing{end_mm, level, passed, true, false, cell_mm}; });
  };
  rays_.alongData(ray, [&](const RayPart& part) {
    const std::vector<double> stops = monotoneStops(part.piece);
    const bool joined = end_mm >= 0 && part.begin_mm - end_mm <= kJoint_mm;
    if (!joined) {
      leave();
      passed = part.passed, cell_mm = part.at(0.5);
      const bool first = part.begin_mm - ray.begin_mm <= kJoint_mm;
      const std::size_t beginning = reached(part.piece(stops.front()));
      if (first && ray.beginsOpen) inside = beginning;
      change(beginning,
             [&](std::size_t level) { return Crossing{part.begin_mm, level, passed, true, first, cell_mm}; });
    }
    passed = part.passed, cell_mm = part.at(0.5);
    double from = stops.front();
    for (std::size_t n = 1; n < stops.size(); ++n) {
      change(reached(part.piece(stops[n])), [&](std::size_t level) {
        const double u = crossing(part.piece, levels_[level], from, stops[n]);
        return Crossing{part.at(u), level, passed, false, false, cell_mm};
      });
      from = stops[n];
    }
    end_mm = part.end_mm;
    return going;
  });
  const bool atTool = ray.endedBy == Border::Tool && ray.end_mm - end_mm <= kJoint_mm;
  const bool open = ray.endsOpen && ray.end_mm - end_mm <= kJoint_mm;
  if (going && !atTool && !open) leave();
}

double ShellsReference::brightness(const VolumeRay& ray, const Crossing& c) const {
  const double z = rays_.z(ray, c.t_mm);
  return ray.through[c.passed] * phi_[c.level] * (layer_.beta0 + layer_.betaM * (layer_.a * z + layer_.b));
}

void ShellsReference::greatest(const VolumeRay& ray, Volume& v) const {
  if (levels_.empty()) return;
  const double k0 = layer_.beta0 + layer_.betaM * layer_.b, k1 = layer_.betaM * layer_.a;
  rays_.alongData(ray, [&](const RayPart& part) {
    v.shown = true;
    v.replaces = v.replaces || part.piece.extremes().max >= levels_.front();
    const double through = ray.through[part.passed];
    if (through > 0)
      v.value = std::max(v.value, through * brightest(part.piece, rays_.window(),
                                                      rays_.cue(ray, part, k0, k1), v.value / through));
    return true;
  });
}

void ShellsReference::sum(const VolumeRay& ray, Volume& v) const {
  crossings(ray, [&](const Crossing& c) {
    v.shown = true;
    v.value += brightness(ray, c);
    return true;
  });
}

// The face of a cell, or of a slice's hold (half a voxel), at which data begin: that which the ray passes
// nearest to the place.
glm::dvec3 ShellsReference::faceNormal(const VolumeRay& ray, double t_mm) const {
  const glm::dmat3& toVoxel = rays_.volume().voxelFromPatient().linear;
  const glm::dvec3 p = 2.0 * rays_.voxelAt(ray, t_mm), off_vox = glm::abs(p - glm::round(p)),
                   perMm = glm::abs(toVoxel * ray.line.direction);
  int nearest = 0;
  double off_mm = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis)
    if (perMm[axis] > 1e-12 && off_vox[axis] / perMm[axis] < off_mm)
      nearest = axis, off_mm = off_vox[axis] / perMm[axis];
  return glm::normalize(glm::transpose(toVoxel)[nearest]);
}

std::optional<RayTool> ShellsReference::firstShell(const VolumeRay& ray) const {
  std::optional<RayTool> out;
  crossings(ray, [&](const Crossing& c) {
    const glm::dvec3 normal = !c.cap    ? rays_.gradient(ray, c.t_mm, c.cell_mm)
                              : c.first ? ray.beginNormal
                                        : faceNormal(ray, c.t_mm);
    const double cosine = std::abs(glm::dot(normal, ray.line.direction));
    out = RayTool{c.t_mm, shareOfHeadlight(cosine) * colour_, 1};
    return false;
  });
  return out;
}

VolumeSeen ShellsReference::seen(glm::dvec2 pixel) const {
  VolumeRay ray = rays_.ray(pixel);
  VolumeSeen out;
  Volume v;
  if (layer_.mode == ShellsMode::Max) greatest(ray, v);
  if (layer_.mode == ShellsMode::Sum) sum(ray, v);
  if (layer_.mode == ShellsMode::Lit)
    if (const auto hit = firstShell(ray)) {
      v.shown = true;
      ray.opaque = *hit;
      std::erase_if(ray.tools, [&](const RayTool& t) { return t.t_mm > hit->t_mm; });
      ray.through.resize(ray.tools.size() + 1);
    }
  out.shown = v.shown;
  out.covered = v.shown || ray.opaque || !ray.tools.empty();
  for (std::size_t n = 0; n < ray.tools.size(); ++n)
    out.colour += ray.through[n] * ray.tools[n].opacity * ray.tools[n].colour;
  const glm::dvec3 shells = v.value * colour_, floor = layer_.beta0 * layer_.phi0 * colour_;
  if (layer_.mode == ShellsMode::Lit || (!v.shown && layer_.mode == ShellsMode::Sum)) {
    out.colour += ray.backdrop(background_);
  } else if (layer_.mode == ShellsMode::Sum) {
    out.colour += shells + ray.backdrop(glm::dvec3(0));
  } else if (ray.opaque) {
    const glm::dvec3 tool = ray.backdrop(glm::dvec3(0));
    if (layer_.surfaceBlend == SurfaceBlend::Max)
      out.colour += glm::max(shells, tool);
    else
      out.colour += v.replaces ? shells : tool;
  } else {
    out.colour += glm::max(shells, ray.through.back() * (v.shown ? floor : glm::max(floor, background_)));
  }
  return out;
}

Gathering ShellsReference::gathered(const VolumeRay& whole, std::span<const VolumeRay> parts) const {
  const bool max = layer_.mode == ShellsMode::Max;
  Volume v;
  for (const VolumeRay& part : parts) max ? greatest(part, v) : sum(part, v);
  Gathering g;
  g.accumulator = max ? Accumulator::Max : Accumulator::Sum;
  g.covered = v.shown;
  g.value = v.value * colour_;
  g.bare = background_;
  g.reaching.assign(whole.tools.size(), 1);
  if (!max) return g;
  if (whole.opaque && layer_.surfaceBlend == SurfaceBlend::Replace) g.covered = g.replacesTool = v.replaces;
  const glm::dvec3 floor = layer_.beta0 * layer_.phi0 * colour_;
  if (!whole.opaque) g.value = glm::max(g.value, whole.through.back() * floor);
  g.bare = glm::max(floor, background_);
  return g;
}

PartSeen ShellsReference::part(const VolumeRay& ray) const {
  const auto hit = firstShell(ray);
  return hit ? PartSeen{hit->colour, 0} : PartSeen{};
}

PartMark ShellsReference::mark(const VolumeRay& part) const {
  PartMark mark;
  if (layer_.mode == ShellsMode::Max) {
    rays_.alongData(part, [&](const RayPart&) {
      mark.shown = true;
      return false;
    });
    return mark;
  }
  crossings(part, [&](const Crossing& c) {
    mark.shown = true;
    if (lit()) mark.left = 0, mark.end_mm = c.t_mm;
    return false;
  });
  return mark;
}

std::uint64_t ShellsReference::edgeKey(glm::dvec2 pixel) const {
  const VolumeRay ray = rays_.ray(pixel);
  return VolumeRays::edgeKey(ray, mark(ray).shown);
}

bool ShellsReference::contributes(const LocalRange& values) const {
  if (levels_.empty() || values.min > values.max) return false;
  if (layer_.mode == ShellsMode::Max)
    return background_ != glm::dvec3(0) || layer_.phi0 > 0 || windowGrey(rays_.window(), values.max) > 0;
  return values.max >= levels_.front();
}

}  // namespace vernier::quality
