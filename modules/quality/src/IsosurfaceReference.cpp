// SPDX-License-Identifier: GPL-3.0-or-later
#include "IsosurfaceReference.h"

#include <cmath>

#include "FrontToBack.h"
#include "vernier/volume/TransferFunction.h"

namespace vernier::quality {
namespace {

// Data that end and begin again within less than this (mm) do not end.
constexpr double kJoint_mm = 1e-9;

}  // namespace

Result<IsosurfaceReference> IsosurfaceReference::make(const Scene& scene, const IsosurfaceLayer& layer,
                                                      const View& view, const Sources& sources) {
  auto rays = VolumeRays::make(scene, layer.source, Interpolation::Linear, std::nullopt, view, sources);
  if (!rays) return rays.error();
  if (!layer.combiner.empty())
    return makeError(ErrorCode::NotBuiltYet,
                     "What the combiner '" + layer.combiner +
                         "' makes of a surface is its file's matter; the reference knows the layer's own "
                         "material only, so no error is measured.");
  auto shading = Shading::make(scene, layer.material);
  if (!shading) return shading.error();
  IsosurfaceReference r(std::move(*rays));
  r.level_ = layer.level.value_or(defaultIsoLevel(r.rays_.volume()));
  if (!std::isfinite(r.level_))
    return makeError(ErrorCode::SceneInvalid, "The level of an iso-surface must be a finite number.");
  r.shading_ = std::move(*shading);
  r.gradient_.emplace(r.rays_.volume(), Interpolation::Linear);
  r.background_ = {scene.background.r, scene.background.g, scene.background.b};
  r.rays_.findBricks();
  for (const BrickRanges::Brick& b : r.rays_.bricks()->bricks())
    r.reaching_.push_back(r.contributes(b.values) ? 1 : 0);
  return r;
}

std::optional<IsosurfaceReference::Hit> IsosurfaceReference::firstHit(const VolumeRay& ray) const {
  std::optional<Hit> hit;
  double end_mm = -1;  // of the data so far, in bricks that reach the level
  const auto at = [&](const RayPart& part, double u, bool face) {
    const glm::dvec3 gradient =
        face ? ray.line.direction : gradient_->at(part.from_vox + u * part.across_vox);
    hit = Hit{part.at(u), part.passed, face, gradient};
    return false;
  };
  rays_.alongBricks(
      ray, [&](std::size_t brick) { return reaching_[brick] != 0; },
      [&](const RayPart& part) {
        const bool joined = end_mm >= 0 && part.begin_mm - end_mm <= kJoint_mm;
        end_mm = part.end_mm;
        if (part.piece.plain) {  // no higher than the control points of its Bezier form
          const auto& c = part.piece.numerator.c;
          if (std::max({c[0], c[0] + c[1] / 3, c[0] + (2 * c[1] + c[2]) / 3, part.piece.numerator(1)}) <
              level_)
            return true;
        }
        const std::vector<double> stops = monotoneStops(part.piece);
        if (part.piece(stops.front()) >= level_) return at(part, stops.front(), !joined);
        for (std::size_t n = 0; n + 1 < stops.size(); ++n)
          if (part.piece(stops[n + 1]) >= level_)
            return at(part, crossing(part.piece, level_, stops[n], stops[n + 1]), false);
        return true;
      });
  return hit;
}

VolumeSeen IsosurfaceReference::seen(glm::dvec2 pixel) const {
  const VolumeRay ray = rays_.ray(pixel);
  const std::optional<Hit> hit = firstHit(ray);
  FrontToBack light;
  const std::size_t tools = hit ? hit->passed : ray.tools.size();
  for (std::size_t n = 0; n < tools; ++n) light.cover(ray.tools[n].colour, ray.tools[n].opacity);
  if (hit)
    light.cover(shading_->lit(hit->gradient, ray.line.direction), 1);
  else
    light.cover(ray.opaque ? ray.opaque->colour : background_, 1);
  VolumeSeen out;
  out.colour = light.colour;
  out.shown = hit.has_value();
  out.covered = out.shown || ray.opaque || !ray.tools.empty();
  if (hit) out.value = level_;
  return out;
}

PartSeen IsosurfaceReference::part(const VolumeRay& ray) const {
  const std::optional<Hit> hit = firstHit(ray);
  return hit ? PartSeen{shading_->lit(hit->gradient, ray.line.direction), 0} : PartSeen{};
}

EdgeMark::Hit IsosurfaceReference::markOf(const Hit& hit, const VolumeRay& ray) {
  const double size = glm::length(hit.gradient);
  EdgeMark::Hit mark{hit.face ? std::size_t{1} : 0, hit.t_mm, size > 0 ? hit.gradient / size : glm::dvec3(0),
                     1};
  if (hit.face && hit.t_mm - ray.begin_mm <= kJoint_mm) mark.normal = ray.beginNormal;
  return mark;
}

PartMark IsosurfaceReference::mark(const VolumeRay& part, double left, std::size_t surfaces,
                                   std::vector<EdgeMark::Hit>& hits) const {
  const std::optional<Hit> hit = firstHit(part);
  if (!hit) return {false, false};
  hits.push_back(markOf(*hit, part));
  hits.back().surface += surfaces, hits.back().left = left;
  return {true, hit->face, 0, hit->t_mm};
}

EdgeMark IsosurfaceReference::edgeMark(glm::dvec2 pixel) const {
  const VolumeRay ray = rays_.ray(pixel);
  EdgeMark mark;
  mark.line = ray.line, mark.voxel_mm = rays_.largestSpacing_mm();
  const std::optional<Hit> hit = firstHit(ray);
  VolumeRay before = ray;  // tools and cuts behind the hit make no edge
  if (hit) {
    before.opaque.reset();
    before.tools.resize(hit->passed);
    before.endedBy = Border::Box;
    if (!hit->face) before.begunBy = Border::Box;
    mark.hits.push_back(markOf(*hit, ray));
  } else {
    before.begin_mm = 0, before.end_mm = -1;  // nor do cuts through what is not shown
  }
  mark.key = VolumeRays::edgeKey(before, hit.has_value());
  return mark;
}

}  // namespace vernier::quality
