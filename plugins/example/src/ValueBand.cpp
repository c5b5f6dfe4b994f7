// SPDX-License-Identifier: GPL-3.0-or-later
#include "ValueBand.h"

#include <algorithm>
#include <memory>
#include <variant>

#include "vernier/base/Threads.h"
#include "vernier/plan/PictureGeometry.h"
#include "vernier/plan/SceneJson.h"
#include "vernier/volume/Sampling.h"

namespace example {
namespace {
using namespace vernier;

const char* const kTechnique = "example.band.native";
constexpr double kNsPerSample = 120;  // one trilinear sample in double on one core, measured
constexpr glm::dvec3 kColour{1.0, 0.55, 0.1};

// 1. The controls. Each edits one key of the layer's JSON.
const PanelSlider kLow{"low", "From", -1024, 4096, 1, 300, "HU"};
const PanelSlider kHigh{"high", "To", -1024, 4096, 1, 3000, "HU"};
const PanelSlider kOpacity{"opacity", "Opacity", 0, 1, 0, 0.5, ""};
const PanelCheckbox kOutline{"outline", "Outline only", false};

// 2. What one pass needs to know, worked out when the plan is made. Immutable.
struct BandParams final : PassParams {
  std::shared_ptr<const Volume> volume;
  SlicePicture picture;
  View view;
  Interpolation interpolation = Interpolation::Linear;
  Rgb background;
  double low = 0, high = 0, opacity = 0;
  bool outline = false;

  std::string dump() const override {
    return "band " + std::to_string(low) + " to " + std::to_string(high) + (outline ? " outline" : "");
  }
  // Does the value at a point of the picture (pixels, centres at half-integers) lie in the band? No-data does
  // not.
  bool inside(glm::dvec2 pixel) const {
    const PatientPoint p = picture.origin + pixel.x * picture.right + pixel.y * picture.down;
    const std::optional<double> value = sampleModality(*volume, p, interpolation);
    return value && *value >= low && *value <= high;
  }
  bool marked(glm::dvec2 pixel) const {
    if (!inside(pixel)) return false;
    return !outline || !inside(pixel + glm::dvec2(1, 0)) || !inside(pixel - glm::dvec2(1, 0)) ||
           !inside(pixel + glm::dvec2(0, 1)) || !inside(pixel - glm::dvec2(0, 1));
  }
};

// The slice that the band lies on: the nearest one below it.
Result<const SliceLayer*> sliceBelow(const Scene& scene, std::size_t index) {
  for (std::size_t n = index; n-- > 0;)
    if (const auto* slice = std::get_if<SliceLayer>(&scene.layers[n])) return slice;
  return makeError(ErrorCode::SceneInvalid, "A value band needs a slice layer below it; put one before it.",
                   "/layers/" + std::to_string(index));
}

// What the layer says under a control's key. An error names its place in the scene: "/layers/1/low".
template <class Control>
auto valueOf(const CustomLayer& layer, std::size_t index, const Control& control)
    -> Result<decltype(control.initial)> {
  const Result<PanelValue> value = panelValue(layer, control);
  if (!value)
    return makeError(value.error().code, value.error().sentence,
                     "/layers/" + std::to_string(index) + value.error().where);
  return std::get<decltype(control.initial)>(*value);
}

Result<std::shared_ptr<const BandParams>> paramsFor(const Layer& layer, std::size_t index,
                                                    const PlanContext& context) {
  const auto* custom = std::get_if<CustomLayer>(&layer);
  if (!custom) return makeError(ErrorCode::Internal, "The layer is no value band.", kTechnique);
  const auto slice = sliceBelow(context.scene, index);
  if (!slice) return slice.error();
  if ((*slice)->slab.thickness_mm > 0)
    return makeError(ErrorCode::SceneInvalid,
                     "A value band reads a single slice, not a slab; set the slab to 0 mm.",
                     "/layers/" + std::to_string(index));
  const auto low = valueOf(*custom, index, kLow), high = valueOf(*custom, index, kHigh);
  const auto opacity = valueOf(*custom, index, kOpacity);
  const auto outline = valueOf(*custom, index, kOutline);
  for (const auto* number : {&low, &high, &opacity})
    if (!*number) return number->error();
  if (!outline) return outline.error();

  const auto volumeOf = [&](const std::string& source) -> std::shared_ptr<const Volume> {
    const auto found = context.sources.volumes.find(source);
    return found == context.sources.volumes.end() ? nullptr : found->second;
  };
  auto p = std::make_shared<BandParams>();
  const auto ground = volumeOf((*slice)->source);  // whose box the picture is fitted to
  p->volume = volumeOf(sourceOf(*custom).value_or((*slice)->source));
  if (!ground || !p->volume)
    return makeError(ErrorCode::SceneInvalid, "The volume that the value band names is not loaded.",
                     "/layers/" + std::to_string(index));
  const Result<SlicePicture> picture = slicePicture(**slice, context.scene.camera, context.view, *ground);
  if (!picture) return picture.error();
  p->picture = *picture, p->view = context.view, p->background = context.scene.background;
  p->interpolation = (*slice)->interpolation;
  p->low = *low, p->high = *high, p->opacity = *opacity, p->outline = *outline;
  return std::shared_ptr<const BandParams>(std::move(p));
}

// 3. The plan: which passes, what they cost and how wrong they may be. Pure.
Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  const auto params = paramsFor(layer, index, context);
  if (!params) return params.error();
  const auto known = context.costs.nsPerSample.find(kTechnique);
  const double ns = known == context.costs.nsPerSample.end() ? kNsPerSample : known->second;
  const double samples =
      static_cast<double>(context.view.width_px) * context.view.height_px * ((*params)->outline ? 5 : 1);
  Pass pass;
  pass.name = "band " + std::to_string(index);
  pass.inputs = {"volume", "colour"};  // "colour": it draws over what lies below
  pass.outputs = {"colour"};
  pass.predicted_ms = samples * ns * 1e-6 / std::max(1, context.capabilities.threads);
  pass.predictedError = 255.0 / (1 << 24);  // the colour is kept as float; all else is double
  pass.params = *params;
  return std::vector<Pass>{std::move(pass)};
}

// 4. The drawing. Rows are spread over the cores; the stop token is asked once a row.
Result<void> execute(const Pass& pass, Images& images, std::stop_token stop) {
  const auto* p = dynamic_cast<const BandParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no band parameters.", kTechnique);
  const auto width = static_cast<std::size_t>(p->view.width_px);
  const auto mix = [&](float& under, double over) {
    under = static_cast<float>((1 - p->opacity) * static_cast<double>(under) + p->opacity * over);
  };
  parallelFor(static_cast<std::size_t>(p->view.height_px), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end && !stop.stop_requested(); ++y)
      for (std::size_t x = 0; x < width; ++x) {
        if (!p->marked({static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5})) continue;
        float* rgba = &images.colour[4 * (x + width * y)];
        for (int c = 0; c < 3; ++c) mix(rgba[c], kColour[c]);
        rgba[3] = 1;
      }
  });
  if (stop.stop_requested())
    return makeError(ErrorCode::Cancelled, "The value band was cancelled.", pass.name);
  images.counters.samples += width * static_cast<std::size_t>(p->view.height_px);
  return {};
}

// 5. The truth that the picture's measured error is taken against: one pixel in double, over what lies below
// it.
Result<PixelTruth> truth(const Layer& layer, std::size_t index, const PlanContext& context) {
  const auto params = paramsFor(layer, index, context);
  if (!params) return params.error();
  return PixelTruth([p = *params](glm::dvec2 pixel, glm::dvec4 under) {
    if (!p->marked(pixel)) return under;
    return glm::dvec4((1 - p->opacity) * glm::dvec3(under) + p->opacity * kColour, 1);
  });
}

}  // namespace

Panel bandPanel() {
  Panel panel;
  panel.title = "Value band";
  panel.kind = "example.band";
  panel.controls = {PanelLabel{"Colours what lies between two values."}, kLow, kHigh, kOpacity, kOutline};
  return panel;
}

Technique bandTechnique() {
  Technique t;
  t.name = kTechnique;
  t.kinds = {"example.band"};
  t.engine = Engine::Native;
  t.passesFor = passesFor;
  t.execute = execute;
  t.truth = truth;
  return t;
}

}  // namespace example
