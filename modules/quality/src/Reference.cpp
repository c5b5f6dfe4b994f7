// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/quality/Reference.h"

#include <utility>

#include "Layers.h"
#include "vernier/base/Threads.h"

namespace vernier::quality {
namespace {

constexpr std::size_t kGrain = 32;

Result<void> checkView(const View& view) {
  if (view.width_px < 1 || view.height_px < 1)
    return makeError(ErrorCode::SceneInvalid,
                     "The picture has no pixels; give a width and height of at least 1.");
  return {};
}

}  // namespace

Result<Layers> Layers::make(const Scene& scene, const View& view, const Sources& sources,
                            const ReferenceOptions& options) {
  if (auto r = checkView(view); !r) return r.error();
  if (!(options.step > 0)) return makeError(ErrorCode::SceneInvalid, "The sampling step must be above 0.");
  Layers all;
  all.background_ = glm::dvec3(scene.background.r, scene.background.g, scene.background.b);
  for (std::size_t n = 0; n < scene.layers.size(); ++n) {
    const Layer& layer = scene.layers[n];
    if (const auto truth = options.truths.find(n); truth != options.truths.end()) {
      all.layers_.push_back({truth->second, 0});
    } else if (const auto* slice = std::get_if<SliceLayer>(&layer)) {
      auto r = SliceReference::make(scene, *slice, view, sources);
      if (!r) return r.error();
      const int samples = r->samplesFor(options);
      all.layers_.push_back({std::move(*r), samples});
    } else if (const auto* image = std::get_if<ImageLayer>(&layer)) {
      auto r = ImageReference::make(scene, *image, view, sources);
      if (!r) return r.error();
      all.layers_.push_back({std::move(*r), 0});
    } else {
      return makeError(ErrorCode::NotBuiltYet, "The reference cannot draw layers of kind '" + kindOf(layer) +
                                                   "' yet, so no error is measured.");
    }
  }
  return all;
}

bool Layers::covers(glm::dvec2 pixel) const {
  for (const Prepared& p : layers_) {
    if (const auto* slice = std::get_if<SliceReference>(&p.layer)) {
      if (slice->covers(pixel, p.samples)) return true;
    } else if (const auto* image = std::get_if<ImageReference>(&p.layer)) {
      if (image->value(pixel)) return true;
    }
  }
  return false;
}

// Later layers lie over earlier ones: slices and images opaque where they have data, a plugin's as it says.
ReferencePixel Layers::at(glm::dvec2 pixel, std::optional<SliceValue>* sliceOut) const {
  std::size_t above = 0;
  ReferencePixel out = ground(pixel, sliceOut, above);
  for (; above < layers_.size(); ++above)
    if (const auto* truth = std::get_if<PixelTruth>(&layers_[above].layer))
      out.rgba = (*truth)(pixel, out.rgba);
  return out;
}

ReferencePixel Layers::ground(glm::dvec2 pixel, std::optional<SliceValue>* sliceOut,
                              std::size_t& above) const {
  ReferencePixel out;
  out.rgba = glm::dvec4(background_, 1);
  for (auto p = layers_.rbegin(); p != layers_.rend(); ++p) {
    const auto* slice = std::get_if<SliceReference>(&p->layer);
    const auto* image = std::get_if<ImageReference>(&p->layer);
    if (!slice && !image) continue;
    std::optional<double> v;
    if (slice) {
      const auto s = slice->value(pixel, p->samples);
      if (s) v = s->value;
      if (s && sliceOut) *sliceOut = s;
    } else {
      v = image->value(pixel);
    }
    if (!v) continue;
    const double grey = slice ? slice->grey(*v) : image->grey(*v);
    out.rgba = glm::dvec4(grey, grey, grey, 1);
    out.value = *v;
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
  const auto* slice = layer < scene.layers.size() ? std::get_if<SliceLayer>(&scene.layers[layer]) : nullptr;
  if (!slice)
    return makeError(ErrorCode::SceneInvalid,
                     "Layer " + std::to_string(layer) + " of the scene is no slice.");
  const auto reference = SliceReference::make(scene, *slice, view, sources);
  if (!reference) return reference.error();
  const int samples = reference->samplesFor(options);
  std::vector<std::optional<SliceValue>> out(points_px.size());
  parallelFor(points_px.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) out[n] = reference->value(points_px[n], samples);
  });
  return out;
}

}  // namespace vernier::quality
