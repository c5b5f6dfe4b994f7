// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>
#include <cmath>

#include "SliceParams.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Voi.h"

namespace vernier::mpr {
namespace {

// A slab of a kilometre covers any patient; more is a slip of the keyboard.
constexpr double kLargestSlab_mm = 1e6;

std::string number(double v) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::general, 6);
  return std::string(text, end.ptr);
}

std::string vector3(const glm::dvec3& v) { return number(v.x) + "," + number(v.y) + "," + number(v.z); }

const char* nameOfMode(SlabMode mode) {
  return mode == SlabMode::Max ? "max" : mode == SlabMode::Min ? "min" : "mean";
}

const char* nameOfInterpolation(Interpolation i) {
  return i == Interpolation::Linear ? "linear" : i == Interpolation::Cubic ? "cubic" : "nearest";
}

const char* nameOfFunction(VoiFunction f) {
  return f == VoiFunction::Linear ? "" : f == VoiFunction::LinearExact ? " exact" : " sigmoid";
}

Result<int> slabSamplesOf(const Volume& volume, double thickness_mm, double step) {
  if (!(thickness_mm >= 0 && thickness_mm <= kLargestSlab_mm))
    return makeError(ErrorCode::SceneInvalid, "The slab is " + number(thickness_mm) +
                                                  " mm thick; give 0 (a single slice) to 1000000 mm.");
  if (!(step > 0)) return makeError(ErrorCode::SceneInvalid, "The sampling step must be above 0.");
  if (thickness_mm == 0) return 1;
  const glm::dvec3 s = volume.grid().spacing_mm();
  const double n = std::ceil(thickness_mm / (step * std::min({s.x, s.y, s.z})));
  return static_cast<int>(std::clamp(n, 1.0, 1e9));
}

}  // namespace

std::string SampledParams::dumpSampling() const {
  std::string s = nameOfInterpolation(interpolation);
  if (slab.thickness_mm > 0)
    s += " slab " + number(slab.thickness_mm) + " mm " + nameOfMode(slab.mode) +
         (slabSamples > 0 ? " of " + std::to_string(slabSamples) : " of the whole line");
  if (volume && volume->isColour())
    s += " colour of " + std::to_string(volume->info().channels) + " channels";
  else
    s += " window " + number(window.center) + "/" + number(window.width) + nameOfFunction(window.function);
  if (invert) s += " inverted";
  return s;
}

std::string SliceParams::dump() const {
  return "slice " + std::to_string(view.width_px) + "x" + std::to_string(view.height_px) + " from " +
         vector3(picture.origin.p) + " right " + vector3(picture.right.v) + " down " +
         vector3(picture.down.v) + " " + dumpSampling() +
         (lenses.empty() ? "" : ", lenses " + std::to_string(lenses.size()));
}

std::string CurvedParams::dump() const {
  return "curved " + std::to_string(view.width_px) + "x" + std::to_string(view.height_px) +
         (form == CurvedForm::Straightened ? " straightened " : " stretched ") + number(picture.length_mm) +
         " x " + number(picture.across_mm) + " mm, " + number(picture.mmPerPixel) + " mm per pixel " +
         dumpSampling();
}

namespace {

// Of a slice or curved layer, all but where it lies.
template <class L>
Result<void> sampling(const L& layer, const PlanContext& context, Colours colours, SampledParams& p) {
  const auto found = context.sources.volumes.find(layer.source);
  if (found == context.sources.volumes.end() || !found->second)
    return makeError(ErrorCode::SceneInvalid,
                     "The volume that the " + kindOf(layer) + " layer names is not loaded.");
  p.volume = found->second;
  if (p.volume->isColour() && colours == Colours::Refused)
    return makeError(ErrorCode::NoTechnique, "it draws grey volumes only");
  p.view = context.view;
  p.slab = layer.slab;
  Result<int> samples = slabSamplesOf(*p.volume, p.slab.thickness_mm, context.quality.step);
  if (!samples) return samples.error();
  p.slabSamples = *samples;
  p.interpolation = layer.interpolation;
  p.window = normalised(layer.window && !p.volume->isColour() ? *layer.window : defaultWindow(*p.volume));
  if (!usableWindow(p.window))
    return makeError(ErrorCode::SceneInvalid, "The window's width must be above 0 and its numbers finite.");
  p.invert = layer.invert != p.volume->info().inverted;
  p.background = context.scene.background;
  return {};
}

}  // namespace

std::vector<std::string> notesOf(const SliceLayer& layer, const SliceParams& p) {
  if (p.volume->isColour() && layer.window) return {"window not applied: a colour volume has none"};
  return {};
}

Result<std::shared_ptr<const SliceParams>> sliceParams(const Layer& layer, const PlanContext& context,
                                                       Colours colours) {
  const auto* slice = std::get_if<SliceLayer>(&layer);
  if (!slice) return makeError(ErrorCode::SceneInvalid, "The layer is not a slice.");
  auto p = std::make_shared<SliceParams>();
  if (Result<void> r = sampling(*slice, context, colours, *p); !r) return r.error();
  Result<SlicePicture> picture = slicePicture(*slice, context.scene.camera, context.view, *p->volume);
  if (!picture) return picture.error();
  p->picture = *picture;
  return std::shared_ptr<const SliceParams>(std::move(p));
}

Result<std::shared_ptr<const CurvedParams>> curvedParams(const Layer& layer, const PlanContext& context) {
  const auto* curved = std::get_if<CurvedLayer>(&layer);
  if (!curved) return makeError(ErrorCode::SceneInvalid, "The layer is not a curved reformat.");
  auto p = std::make_shared<CurvedParams>();
  if (Result<void> r = sampling(*curved, context, Colours::Refused, *p); !r) return r.error();
  Result<CurvedPicture> picture = curvedPicture(*curved, context.scene.camera, context.view);
  if (!picture) return picture.error();
  p->picture = std::move(*picture);
  p->form = curved->form;
  return std::shared_ptr<const CurvedParams>(std::move(p));
}

void fitImages(Images& images, const View& view) {
  const std::size_t pixels =
      static_cast<std::size_t>(view.width_px) * static_cast<std::size_t>(view.height_px);
  if (images.width != view.width_px || images.height != view.height_px ||
      images.colour.size() != 4 * pixels || images.depth.size() != pixels ||
      (view.wantValues && images.values.size() != pixels))
    images.allocate(view.width_px, view.height_px, view.wantValues);
  if (!view.wantValues) images.values.clear();
}

}  // namespace vernier::mpr
