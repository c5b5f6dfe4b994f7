// SPDX-License-Identifier: GPL-3.0-or-later
#include "VolumeReference.h"

#include <cmath>

namespace vernier::quality {
namespace {

// Data that end and begin again within less than this (mm) do not end.
constexpr double kJoint_mm = 1e-9;
constexpr std::size_t kMostHits = 64;  // that are compared between neighbours
// Surfaces at which data begin are told from steps by this.
constexpr std::size_t kCap = std::size_t{1} << 32;

// Bounds of the field on a piece, from the control points of its Bezier form; next to no-data its extremes.
LocalRange boundsOf(const Piece& p) {
  if (!p.plain) return p.extremes();
  const auto& c = p.numerator.c;
  LocalRange r;
  for (double v : {c[0], c[0] + c[1] / 3, c[0] + (2 * c[1] + c[2]) / 3, p.numerator(1)}) r.add(v);
  return r;
}

Error notBuilt(const std::string& sentence) { return makeError(ErrorCode::NotBuiltYet, sentence); }

// What the lattice of samples is known for.
Result<void> checkSampled(const VolumeLayer& layer) {
  if (layer.mode != VolumeMode::Blend)
    return notBuilt(
        "The reference samples blended volumes as an engine does, and knows of maxima and minima the "
        "continuous truth only (the model error).");
  if (layer.classification != Classification::Post)
    return notBuilt(
        "The reference samples a volume as an engine does where the layer asks for post-classification; of "
        "other classifications, and of one that the planner chooses, it knows the model error only.");
  return {};
}

}  // namespace

Result<VolumeReference> VolumeReference::make(const Scene& scene, const VolumeLayer& layer, const View& view,
                                              const Sources& sources, const ReferenceOptions& options) {
  auto rays = VolumeRays::make(scene, layer.source, layer.interpolation, std::nullopt, view, sources,
                               VolumeRays::Colours::Taken);
  if (!rays) return rays.error();
  if (!layer.combiner.empty())
    return notBuilt("What the combiner '" + layer.combiner +
                    "' makes of a sample is its file's matter; the reference knows the layer's own shading "
                    "only, so no error is measured.");
  VolumeReference r(std::move(*rays), layer);
  const Volume& volume = r.rays_.volume();
  const glm::dvec3 s = volume.grid().spacing_mm();
  r.smallest_mm_ = std::min({s.x, s.y, s.z});
  r.background_ = {scene.background.r, scene.background.g, scene.background.b};
  if (options.kind == ErrorKind::Implementation) {
    if (auto ok = checkSampled(layer); !ok) return ok.error();
    r.step_mm_ = options.step * r.smallest_mm_;
  }
  if (volume.isColour()) {
    if (auto ok = r.readColours(); !ok) return ok.error();
  } else {
    auto function =
        layer.transfer
            ? Result<TransferFunction>(*layer.transfer)
            : transferPreset(layer.preset.empty() ? defaultTransferPreset(volume) : layer.preset, volume);
    if (!function) return function.error();
    auto transfer = Transfer::make(*function);
    if (!transfer) return transfer.error();
    r.transfer_ = std::move(*transfer);
    auto shading = Shading::make(scene, layer.material);
    if (!shading) return shading.error();
    r.shading_ = std::move(*shading);
    r.gradient_.emplace(r.rays_.volume(), layer.interpolation);
  }
  r.rays_.findBricks();
  for (const BrickRanges::Brick& b : r.rays_.bricks()->bricks())
    r.showing_.push_back(r.contributes(b.values) ? 1 : 0);
  return r;
}

bool VolumeReference::Walk::passTools(std::size_t upTo) {
  for (; passed < upTo && !light.ended(); ++passed)
    light.cover(ray.tools[passed].colour, ray.tools[passed].opacity);
  return !light.ended();
}

glm::dvec3 VolumeReference::colourOf(std::size_t interval, double value, const glm::dvec3* gradient,
                                     glm::dvec3 ray) const {
  if (!gradient) return transfer_->colour(interval, value);
  return layer_.shading == ShadingModel::GlobalAmbient
             ? shading_->lit(*gradient, ray)
             : shading_->lit(transfer_->colour(interval, value), *gradient, ray);
}

// One stretch of a piece on which the transfer function is a straight line.
bool VolumeReference::blendStretch(const RayPart& part, std::size_t interval, double from, double to,
                                   Gradient::Along* gradient, Walk& walk) const {
  const glm::dvec3 ray = walk.ray.line.direction;
  const auto colour = [&](double u, double value) {
    if (!gradient) return colourOf(interval, value, nullptr, ray);
    const glm::dvec3 g = (*gradient)(u);
    return colourOf(interval, value, &g, ray);
  };
  walk.shown = true;
  if (transfer_->opaque(interval)) {
    walk.light.cover(colour(from, part.piece(from)), 1);
    return false;
  }
  const double length = part.length_mm();
  const auto emission = [&](double u) {
    const double value = part.piece(u), depth = length * transfer_->extinction_perMm(interval, value);
    return Emission{depth, depth > 0 ? colour(u, value) : glm::dvec3(0)};
  };
  // Where the gradient turns from the viewer the normal is turned to him, at once.
  if (gradient)
    for (double u : gradient->turns(ray))
      if (u > from && u < to && !walk.light.ended()) {
        walk.light.absorb(emission, from, u);
        from = u;
      }
  if (!walk.light.ended()) walk.light.absorb(emission, from, to);
  return !walk.light.ended();
}

void VolumeReference::markStep(const RayPart& part, double u, std::size_t surface, bool cap,
                               Walk& walk) const {
  if (!walk.hits || walk.hits->size() >= kMostHits || walk.light.left < EdgeMark::kFound) return;
  const double t = part.at(u);
  const glm::dvec3 g = gradient_->at(part.from_vox + u * part.across_vox);
  const glm::dvec3 normal = !cap                                 ? g
                            : t - walk.ray.begin_mm <= kJoint_mm ? walk.ray.beginNormal
                                                                 : glm::dvec3(0);
  const double size = glm::length(normal);
  walk.hits->push_back({surface, t, size > 0 ? normal / size : glm::dvec3(0), walk.light.left});
}

// Steps that lie between two pieces, and data that begin within what shows.
void VolumeReference::markBeginning(const RayPart& part, const std::vector<double>& stops, Walk& walk) const {
  const double value = part.piece(stops[0]), end = part.piece(stops.back());
  const std::size_t now = transfer_->beside(value, part.piece(stops[1]));
  const std::size_t steps = transfer_->stepsUpTo(now), before = transfer_->stepsUpTo(walk.interval);
  const bool first = part.begin_mm - walk.ray.begin_mm <= kJoint_mm;
  if (walk.end_mm >= 0 && part.begin_mm - walk.end_mm <= kJoint_mm) {
    if (transfer_->shows(now) || transfer_->shows(walk.interval)) {
      for (std::size_t n = before; n < steps; ++n) markStep(part, stops[0], n + 1, false, walk);
      for (std::size_t n = before; n > steps; --n) markStep(part, stops[0], n, false, walk);
    }
  } else if (transfer_->shows(now)) {
    // Behind a brick that shows nothing the field begins where a step is, if not clear.
    const std::size_t upper = now + (value == transfer_->lo(now) ? 0 : 1);
    const bool atStep =
        upper < transfer_->size() && value == transfer_->lo(upper) && transfer_->isStep(upper);
    if (atStep && !first)
      markStep(part, stops[0], transfer_->stepsUpTo(upper), false, walk);
    else if (steps > 0 && transfer_->opacity(transfer_->at(value), value) > 0)
      markStep(part, stops[0], kCap + steps, true, walk);
  }
  walk.interval = transfer_->beside(end, part.piece(stops[stops.size() - 2]));
  walk.end_mm = part.end_mm;
}

bool VolumeReference::blendPart(const RayPart& part, Walk& walk) const {
  if (!walk.passTools(part.passed)) return false;
  const LocalRange bounds = boundsOf(part.piece);
  const bool clear = !transfer_->showsIn(bounds.min, bounds.max);
  if (clear && !walk.hits) return true;
  const std::vector<double> stops = monotoneStops(part.piece);
  if (walk.hits) markBeginning(part, stops, walk);
  if (clear) return true;
  std::optional<Gradient::Along> gradient;
  if (shades() && !walk.plain) gradient.emplace(*gradient_, part);
  for (std::size_t n = 0; n + 1 < stops.size(); ++n) {
    const bool going = transfer_->along(
        part.piece, stops[n], stops[n + 1],
        [&](std::size_t interval, double from, double to) {
          return blendStretch(part, interval, from, to, gradient ? &*gradient : nullptr, walk);
        },
        [&](std::size_t interval, std::size_t next, double u) {
          const std::size_t upper = std::max(interval, next);
          if (transfer_->isStep(upper)) markStep(part, u, transfer_->stepsUpTo(upper), false, walk);
          return true;
        });
    if (!going) return false;
  }
  return true;
}

void VolumeReference::blend(Walk& walk) const {
  if (step_mm_ > 0) return lattice(walk);
  rays_.alongBricks(
      walk.ray, [&](std::size_t brick) { return showing_[brick] != 0; },
      [&](const RayPart& part) { return isColour() ? blendColours(part, walk) : blendPart(part, walk); });
}

VolumeReference::Extreme VolumeReference::extreme(const VolumeRay& ray) const {
  const double sign = layer_.mode == VolumeMode::Max ? 1 : -1;
  Extreme out;
  const auto beats = [&](double value) { return !out.value || sign * value > sign * *out.value; };
  const auto& bricks = rays_.bricks()->bricks();
  rays_.alongBricks(
      ray,
      [&](std::size_t brick) {
        const LocalRange& v = bricks[brick].values;
        return v.min <= v.max && beats(sign > 0 ? v.max : v.min);
      },
      [&](const RayPart& part) {
        const LocalRange bounds = part.piece.plain ? boundsOf(part.piece) : LocalRange{};
        if (part.piece.plain && !beats(sign > 0 ? bounds.max : bounds.min)) return true;
        const LocalRange e = part.piece.extremes();
        const double value = sign > 0 ? e.max : e.min;
        if (beats(value)) out = {value, part.passed};
        return true;
      });
  return out;
}

VolumeSeen VolumeReference::seenExtreme(const VolumeRay& ray) const {
  const Extreme e = extreme(ray);
  Walk walk(ray);
  if (e.value) {
    const std::size_t interval = transfer_->at(*e.value);
    const double opacity = transfer_->opacity(interval, *e.value);
    walk.shown = opacity > 0;
    if (walk.passTools(e.passed)) walk.light.cover(transfer_->colour(interval, *e.value), opacity);
  }
  if (walk.passTools(ray.tools.size())) walk.light.cover(ray.opaque ? ray.opaque->colour : background_, 1);
  return {walk.light.colour, walk.shown, walk.shown || ray.opaque || !ray.tools.empty(), e.value};
}

VolumeSeen VolumeReference::seen(glm::dvec2 pixel) const {
  const VolumeRay ray = rays_.ray(pixel);
  if (layer_.mode != VolumeMode::Blend) return isColour() ? seenColourExtremes(ray) : seenExtreme(ray);
  Walk walk(ray);
  blend(walk);
  if (walk.passTools(ray.tools.size())) walk.light.cover(ray.opaque ? ray.opaque->colour : background_, 1);
  return {walk.light.colour, walk.shown, walk.shown || ray.opaque || !ray.tools.empty(), std::nullopt};
}

bool VolumeReference::hasData(const VolumeRay& ray) const {
  bool data = false;
  rays_.alongData(ray, [&](const RayPart&) {
    data = true;
    return false;
  });
  return data;
}

// The steps that a blended ray shows, until little light is left.
void VolumeReference::markSteps(Walk& walk) const {
  rays_.alongBricks(
      walk.ray, [&](std::size_t brick) { return showing_[brick] != 0; },
      [&](const RayPart& part) {
        return blendPart(part, walk) && walk.light.left >= EdgeMark::kFound && walk.hits->size() < kMostHits;
      });
}

EdgeMark VolumeReference::edgeMark(glm::dvec2 pixel) const {
  const VolumeRay ray = rays_.ray(pixel);
  EdgeMark mark;
  mark.line = ray.line, mark.voxel_mm = rays_.largestSpacing_mm();
  mark.key = VolumeRays::edgeKey(ray, hasData(ray));
  if (isColour() || transfer_->steps() == 0) return mark;
  if (layer_.mode != VolumeMode::Blend) {
    const Extreme e = extreme(ray);
    if (e.value) mark.hits.push_back({transfer_->stepsUpTo(transfer_->at(*e.value)), 0, glm::dvec3(0), 1});
    return mark;
  }
  Walk walk(ray);
  walk.plain = true;
  walk.hits = &mark.hits;
  markSteps(walk);
  return mark;
}

PartSeen VolumeReference::part(const VolumeRay& ray) const {
  Walk walk(ray);
  blend(walk);
  return {walk.light.colour, walk.light.left};
}

PartMark VolumeReference::mark(const VolumeRay& part, double left, std::size_t surfaces,
                               std::vector<EdgeMark::Hit>& hits) const {
  PartMark mark;
  mark.shown = hasData(part);
  if (!mark.shown || isColour() || transfer_->steps() == 0) return mark;
  const std::size_t before = hits.size();
  Walk walk(part);
  walk.plain = true;
  walk.hits = &hits;
  walk.light.left = left;
  markSteps(walk);
  for (std::size_t n = before; n < hits.size(); ++n) hits[n].surface += surfaces;
  mark.left = walk.light.left / left;
  return mark;
}

bool VolumeReference::contributes(const LocalRange& values) const {
  if (values.min > values.max) return false;
  if (!isColour()) return transfer_->showsIn(values.min, values.max);
  // The range is that of alpha, where there is one. An extreme shows where there are data.
  return layer_.mode != VolumeMode::Blend ||
         (layer_.gains[3] > 0 && (rays_.volume().info().channels < 4 || values.max > 0));
}

}  // namespace vernier::quality
