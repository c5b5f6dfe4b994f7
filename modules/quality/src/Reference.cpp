// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/quality/Reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "Layers.h"
#include "vernier/base/Threads.h"

namespace vernier::quality {
namespace {

constexpr std::size_t kGrain = 32;

template <class L>
concept LooksThrough = requires(const L& layer, const LocalRange& values) {
  layer.rays();
  layer.contributes(values);
};

Result<void> checkView(const View& view) {
  if (view.width_px < 1 || view.height_px < 1)
    return makeError(ErrorCode::SceneInvalid,
                     "The picture has no pixels; give a width and height of at least 1.");
  return {};
}

// Beside a slice or a frame, surfaces are outlines, which are drawn after the error is taken.
bool onlySurfaces(const Scene& scene) {
  return std::all_of(scene.layers.begin(), scene.layers.end(),
                     [](const Layer& l) { return std::holds_alternative<SurfaceLayer>(l); });
}

// A camera in space and pictures that lie flat have no common truth, nor have two accumulators on one ray.
Result<void> checkVolumes(const Scene& scene) {
  std::size_t through = 0, flat = 0;
  for (const Layer& l : scene.layers) {
    if (looksThroughVolume(l)) ++through;
    if (std::holds_alternative<SliceLayer>(l) || std::holds_alternative<CurvedLayer>(l) ||
        std::holds_alternative<ImageLayer>(l))
      ++flat;
  }
  if (through > 1)
    return makeError(ErrorCode::NotBuiltYet,
                     "The reference looks through one volume layer at a time; the scene has " +
                         std::to_string(through) + ", so no error is measured.");
  if (through == 1 && flat > 0)
    return makeError(ErrorCode::NotBuiltYet,
                     "The reference does not mix a look through a volume with slices or stored frames, so no "
                     "error is measured.");
  return {};
}

// The layer that lenses stand before; nullopt: there are none. As the planner has it.
Result<std::optional<std::size_t>> behindLenses(const Scene& scene, const ReferenceOptions& options) {
  std::optional<std::size_t> lens, through, slice;
  for (std::size_t n = 0; n < scene.layers.size(); ++n) {
    if (std::holds_alternative<LensLayer>(scene.layers[n]) && !lens) lens = n;
    if (looksThroughVolume(scene.layers[n])) through = n;
    if (std::holds_alternative<SliceLayer>(scene.layers[n]) && !slice) slice = n;
  }
  if (!lens) return std::optional<std::size_t>();
  if (!through && !slice)
    return makeError(ErrorCode::SceneInvalid, "The scene has a lens and nothing that it could look into.");
  if (!options.lenses)
    return makeError(ErrorCode::NotBuiltYet,
                     "The scene has lenses, and their faces were not given to the reference, so no error is "
                     "measured.");
  for (const PlacedLens& placed : *options.lenses)
    if (placed.layer >= scene.layers.size() || !placed.region ||
        !std::holds_alternative<LensLayer>(scene.layers[placed.layer]))
      return makeError(ErrorCode::SceneInvalid,
                       "Layer " + std::to_string(placed.layer) + " of the scene is no lens.");
  if (options.lenses->empty()) return std::optional<std::size_t>();
  return through ? through : slice;
}

}  // namespace

Result<Layers> Layers::make(const Scene& scene, const View& view, const Sources& sources,
                            const ReferenceOptions& options) {
  if (auto r = checkView(view); !r) return r.error();
  if (!(options.step > 0)) return makeError(ErrorCode::SceneInvalid, "The sampling step must be above 0.");
  if (auto r = checkVolumes(scene); !r) return r.error();
  const auto lensed = behindLenses(scene, options);
  if (!lensed) return lensed.error();
  Layers all;
  all.background_ = glm::dvec3(scene.background.r, scene.background.g, scene.background.b);
  for (std::size_t n = 0; n < scene.layers.size(); ++n) {
    if (const auto truth = options.truths.find(n); truth != options.truths.end()) {
      all.layers_.push_back({truth->second, 0});
      continue;
    }
    if (std::holds_alternative<SurfaceLayer>(scene.layers[n])) {
      if (!all.layers_.empty() || !onlySurfaces(scene)) continue;
      auto r = SurfaceReference::make(scene, view, sources);
      if (!r) return r.error();
      all.layers_.push_back({std::move(*r), 0});
      continue;
    }
    if (std::holds_alternative<LensLayer>(scene.layers[n])) continue;
    Result<Prepared> prepared = *lensed == n ? prepareLensed(scene, n, view, sources, options)
                                             : prepare(scene, scene.layers[n], view, sources, options);
    if (!prepared) return prepared.error();
    all.layers_.push_back(std::move(*prepared));
  }
  return all;
}

Result<Layers::Prepared> Layers::prepareLensed(const Scene& scene, std::size_t base, const View& view,
                                               const Sources& sources, const ReferenceOptions& options) {
  if (looksThroughVolume(scene.layers[base])) {
    auto lensed = LensReference::make(scene, base, view, sources, options);
    if (!lensed) return lensed.error();
    return Prepared{*std::move(lensed), 0};
  }
  const auto& layer = std::get<SliceLayer>(scene.layers[base]);
  if (layer.slab.thickness_mm > 0)
    return makeError(ErrorCode::NotBuiltYet,
                     "A lens acts on single slices; of a slab with one no error is measured.");
  Result<Prepared> prepared = prepare(scene, layer, view, sources, options);
  if (!prepared) return prepared;
  auto& slice = std::get<SliceReference>(prepared->layer);
  for (const PlacedLens& lens : *options.lenses)
    if (auto added =
            slice.addLens(lens.region, layer, std::get<LensLayer>(scene.layers[lens.layer]).inner, sources);
        !added)
      return added.error();
  return prepared;
}

Result<Layers::Prepared> Layers::prepare(const Scene& scene, const Layer& layer, const View& view,
                                         const Sources& sources, const ReferenceOptions& options) {
  const auto taken = [&](auto made) -> Result<Prepared> {
    if (!made) return made.error();
    Prepared p{std::move(*made), 0};
    if (const VolumeReading* reading = p.reading()) p.samples = reading->samplesFor(options);
    return p;
  };
  if (const auto* slice = std::get_if<SliceLayer>(&layer))
    return taken(SliceReference::make(scene, *slice, view, sources));
  if (const auto* curved = std::get_if<CurvedLayer>(&layer))
    return taken(CurvedReference::make(scene, *curved, view, sources));
  if (const auto* image = std::get_if<ImageLayer>(&layer))
    return taken(ImageReference::make(scene, *image, view, sources));
  if (const auto* volume = std::get_if<VolumeLayer>(&layer))
    return taken(VolumeReference::make(scene, *volume, view, sources, options));
  if (options.kind == ErrorKind::Implementation)
    return makeError(ErrorCode::NotBuiltYet,
                     "Of layers of kind '" + kindOf(layer) +
                         "' the reference knows the continuous truth only (the model error); how a technique "
                         "samples is for its own tests.");
  if (const auto* projection = std::get_if<ProjectionLayer>(&layer))
    return taken(ProjectionReference::make(scene, *projection, view, sources));
  if (const auto* shells = std::get_if<ShellsLayer>(&layer))
    return taken(ShellsReference::make(scene, *shells, view, sources));
  if (const auto* iso = std::get_if<IsosurfaceLayer>(&layer))
    return taken(IsosurfaceReference::make(scene, *iso, view, sources));
  return makeError(ErrorCode::NotBuiltYet, "The reference cannot draw layers of kind '" + kindOf(layer) +
                                               "' yet, so no error is measured.");
}

const VolumeReading* Layers::Prepared::reading() const {
  if (const auto* slice = std::get_if<SliceReference>(&layer)) return &slice->reading();
  if (const auto* curved = std::get_if<CurvedReference>(&layer)) return &curved->reading();
  return nullptr;
}

std::optional<SliceValue> Layers::Prepared::value(glm::dvec2 pixel) const {
  if (const auto* slice = std::get_if<SliceReference>(&layer)) return slice->value(pixel, samples);
  if (const auto* curved = std::get_if<CurvedReference>(&layer)) return curved->value(pixel, samples);
  const auto* image = std::get_if<ImageReference>(&layer);
  const auto v = image ? image->value(pixel) : std::nullopt;
  return v ? std::optional(SliceValue{*v, *v, *v}) : std::nullopt;
}

bool Layers::Prepared::covers(glm::dvec2 pixel) const {
  if (const auto* slice = std::get_if<SliceReference>(&layer)) return slice->covers(pixel, samples);
  if (const auto* curved = std::get_if<CurvedReference>(&layer)) return curved->covers(pixel, samples);
  if (const auto* surfaces = std::get_if<SurfaceReference>(&layer)) return surfaces->covers(pixel);
  if (const auto v = seen(pixel)) return v->covered;
  const auto* image = std::get_if<ImageReference>(&layer);
  return image && image->covers(pixel);
}

EdgeMark Layers::Prepared::edgeMark(glm::dvec2 pixel) const {
  if (const auto* volume = std::get_if<VolumeReference>(&layer)) return volume->edgeMark(pixel);
  if (const auto* iso = std::get_if<IsosurfaceReference>(&layer)) return iso->edgeMark(pixel);
  if (const auto* lens = std::get_if<LensReference>(&layer)) return lens->edgeMark(pixel);
  EdgeMark mark;
  if (const auto* projection = std::get_if<ProjectionReference>(&layer))
    mark.key = projection->edgeKey(pixel);
  else if (const auto* shells = std::get_if<ShellsReference>(&layer))
    mark.key = shells->edgeKey(pixel);
  else
    mark.key = covers(pixel) ? 1 : 0;
  return mark;
}

std::optional<VolumeSeen> Layers::Prepared::seen(glm::dvec2 pixel) const {
  return std::visit(
      [&](const auto& l) -> std::optional<VolumeSeen> {
        if constexpr (LooksThrough<decltype(l)>) return l.seen(pixel);
        return std::nullopt;
      },
      layer);
}

const VolumeRays* Layers::Prepared::rays() const {
  return std::visit(
      [](const auto& l) -> const VolumeRays* {
        if constexpr (LooksThrough<decltype(l)>) return &l.rays();
        return nullptr;
      },
      layer);
}

std::optional<glm::dvec3> Layers::Prepared::shown(glm::dvec2 pixel, glm::dvec3 background,
                                                  std::optional<SliceValue>* valueOut) const {
  if (const auto* image = std::get_if<ImageReference>(&layer)) {
    double v = std::numeric_limits<double>::quiet_NaN();
    const auto rgb = image->shown(pixel, &v);
    if (rgb && !std::isnan(v)) *valueOut = SliceValue{v, v, v};
    return rgb;
  }
  const auto* slice = std::get_if<SliceReference>(&layer);
  if (slice && slice->volume().isColour()) return slice->colour(pixel, samples, background);
  *valueOut = value(pixel);
  const VolumeReading* r = slice ? slice->readingAt(pixel) : reading();
  return r && *valueOut ? std::optional(glm::dvec3(r->grey((*valueOut)->value))) : std::nullopt;
}

bool Layers::Prepared::contributes(const LocalRange& values) const {
  return std::visit(
      [&](const auto& l) {
        if constexpr (LooksThrough<decltype(l)>) return l.contributes(values);
        return false;
      },
      layer);
}

bool Layers::covers(glm::dvec2 pixel) const {
  return std::any_of(layers_.begin(), layers_.end(), [&](const Prepared& p) { return p.covers(pixel); });
}

EdgeMark Layers::edgeMark(glm::dvec2 pixel) const {
  // A look through a volume is the only layer but for plugins'.
  for (const Prepared& p : layers_)
    if (p.rays()) return p.edgeMark(pixel);
  EdgeMark mark;
  mark.key = covers(pixel) ? 1 : 0;
  for (const Prepared& p : layers_)
    if (const auto* slice = std::get_if<SliceReference>(&p.layer)) mark.key |= slice->lensAt(pixel) << 1;
  return mark;
}

bool Layers::atEdge(glm::dvec2 pixel) const {
  const EdgeMark here = edgeMark(pixel);
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if ((dx != 0 || dy != 0) && edgeBetween(here, edgeMark(pixel + glm::dvec2(dx, dy)))) return true;
  return false;
}

// Later layers lie over earlier ones: those of volumes and frames opaque where they have data, a plugin's as
// it says.
ReferencePixel Layers::at(glm::dvec2 pixel, std::optional<SliceValue>* valueOut) const {
  std::size_t above = 0;
  ReferencePixel out = ground(pixel, valueOut, above);
  for (; above < layers_.size(); ++above)
    if (const auto* truth = std::get_if<PixelTruth>(&layers_[above].layer))
      out.rgba = (*truth)(pixel, out.rgba);
  return out;
}

ReferencePixel Layers::ground(glm::dvec2 pixel, std::optional<SliceValue>* valueOut,
                              std::size_t& above) const {
  ReferencePixel out;
  out.rgba = glm::dvec4(background_, 1);
  for (auto p = layers_.rbegin(); p != layers_.rend(); ++p) {
    if (const auto* surfaces = std::get_if<SurfaceReference>(&p->layer)) {
      const SurfaceReference::Seen seen = surfaces->seen(pixel, background_);
      out.rgba = glm::dvec4(seen.colour, 1);
      out.covered = seen.covered;
      above = static_cast<std::size_t>(layers_.rend() - p);
      break;
    }
    if (const auto seen = p->seen(pixel)) {
      out.rgba = glm::dvec4(seen->colour, 1);
      out.covered = seen->covered;
      if (seen->value) out.value = *seen->value;
      above = static_cast<std::size_t>(layers_.rend() - p);
      break;
    }
    std::optional<SliceValue> v;
    const auto rgb = p->shown(pixel, background_, &v);
    if (!rgb) continue;
    if (v && valueOut && p->reading()) *valueOut = v;
    out.rgba = glm::dvec4(*rgb, 1);
    if (v) out.value = v->value;
    out.covered = true;
    above = static_cast<std::size_t>(layers_.rend() - p);
    break;
  }
  return out;
}

Result<std::vector<ReferencePixel>> referencePixels(const Scene& scene, const View& view,
                                                    const Sources& sources,
                                                    std::span<const std::size_t> pixels,
                                                    const ReferenceOptions& options, std::stop_token stop) {
  const auto layers = Layers::make(scene, view, sources, options);
  if (!layers) return layers.error();
  const std::size_t count =
      static_cast<std::size_t>(view.width_px) * static_cast<std::size_t>(view.height_px);
  for (std::size_t p : pixels)
    if (p >= count)
      return makeError(ErrorCode::SceneInvalid, "Pixel " + std::to_string(p) +
                                                    " lies outside the picture of " + std::to_string(count) +
                                                    " pixels.");
  std::vector<ReferencePixel> out(pixels.size());
  parallelFor(pixels.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    if (stop.stop_requested()) return;
    for (std::size_t n = begin; n < end; ++n) out[n] = layers->at(centreOf(pixels[n], view));
  });
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The error measurement was cancelled.");
  return out;
}

Result<std::vector<std::optional<SliceValue>>> sliceValues(const Scene& scene, std::size_t layer,
                                                           const View& view, const Sources& sources,
                                                           std::span<const glm::dvec2> points_px,
                                                           const ReferenceOptions& options) {
  if (auto r = checkView(view); !r) return r.error();
  if (layer >= scene.layers.size() || !(std::holds_alternative<SliceLayer>(scene.layers[layer]) ||
                                        std::holds_alternative<CurvedLayer>(scene.layers[layer])))
    return makeError(ErrorCode::SceneInvalid,
                     "Layer " + std::to_string(layer) + " of the scene is no slice or curved reformat.");
  const auto prepared = Layers::prepare(scene, scene.layers[layer], view, sources, options);
  if (!prepared) return prepared.error();
  if (const VolumeReading* reading = prepared->reading(); reading && reading->volume().isColour())
    return makeError(ErrorCode::SceneInvalid, "The layer's volume is in colour and has no single values.");
  std::vector<std::optional<SliceValue>> out(points_px.size());
  parallelFor(points_px.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) out[n] = prepared->value(points_px[n]);
  });
  return out;
}

}  // namespace vernier::quality
