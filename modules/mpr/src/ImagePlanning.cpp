// SPDX-License-Identifier: GPL-3.0-or-later
// From an image layer to what its pass needs: which grey transformations hold, the frame's or those of a
// presentation state, which replaces all of them (PS3.4 N.2).
#include <algorithm>
#include <charconv>
#include <cmath>

#include "ImageParams.h"
#include "SliceParams.h"
#include "vernier/volume/Voi.h"

namespace vernier::mpr {
namespace {

constexpr double kBuiltIn_ns = 25.0;
// Rounding alone must not carry a whole number below itself.
constexpr double kRounding = 1e-6;

std::string number(double v) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::general, 6);
  return std::string(text, end.ptr);
}

double lutGrey(const LutTable& lut, double value) {
  const double last = static_cast<double>(lut.data.size() - 1);
  const double entry = std::clamp(std::floor(value - lut.firstMapped + 0.5), 0.0, last);
  return static_cast<double>(lut.data[static_cast<std::size_t>(entry)]) / (std::exp2(lut.bits) - 1.0);
}

bool usable(const LutTable& lut) { return !lut.data.empty() && lut.bits >= 1 && lut.bits <= 16; }

Result<void> takeLut(const LutTable& lut, ImageParams& p) {
  if (!usable(lut)) return makeError(ErrorCode::SceneInvalid, "The VOI LUT is empty or not of 1 to 16 bits.");
  p.voiLut = &lut;
  return {};
}

// All modality values that there can be: what a presentation state without a VOI transformation shows.
VoiWindow wholeRange(const ImageFrameInfo& info, const FramePresentation& f) {
  double lo = 0, hi = 0;
  if (f.modalityLut) {
    hi = std::exp2(f.modalityLut->bits) - 1;
  } else if (info.type == VoxelType::F32) {
    return info.autoWindow;
  } else {
    const bool isSigned =
        info.type == VoxelType::I8 || info.type == VoxelType::I16 || info.type == VoxelType::I32;
    const double least = isSigned ? -std::exp2(info.bitsStored - 1) : 0,
                 most = least + std::exp2(info.bitsStored) - 1;
    lo = std::min(f.rescale.slope * least, f.rescale.slope * most) + f.rescale.intercept;
    hi = std::max(f.rescale.slope * least, f.rescale.slope * most) + f.rescale.intercept;
  }
  return {(lo + hi) / 2, std::max(hi - lo, 1.0), VoiFunction::LinearExact, "whole range"};
}

// The window or VOI LUT: the layer's, else the presentation state's, else the frame's.
Result<void> chooseVoi(const ImageLayer& image, const ImageFrameInfo& info, ImageParams& p) {
  if (image.voiLut) {
    const auto n = static_cast<std::size_t>(*image.voiLut);
    if (*image.voiLut < 0 || n >= info.voiLuts.size())
      return makeError(ErrorCode::SceneInvalid,
                       "The image has no VOI LUT number " + std::to_string(*image.voiLut) + ".");
    return takeLut(info.voiLuts[n], p);
  }
  if (image.window) {
    p.window = *image.window;
  } else if (p.presentation) {
    const FramePresentation& f = *p.presentation;
    if (f.voiLut) return takeLut(*f.voiLut, p);
    p.window = f.window ? *f.window : wholeRange(info, f);
  } else {
    p.window = !info.windows.empty() ? info.windows.front() : info.autoWindow;
  }
  p.window = normalised(p.window);
  if (!usableWindow(p.window))
    return makeError(ErrorCode::SceneInvalid, "The window's width must be above 0 and its numbers finite.");
  return {};
}

// What the layer asks for and cannot be had; said on the picture.
std::vector<std::string> notesOf(const ImageLayer& image, const ImageParams& p) {
  std::vector<std::string> notes;
  if (p.frame->isColour() && (image.window || image.voiLut))
    notes.push_back("window not applied: a colour image has none");
  if (!p.presentation) return notes;
  for (const std::string& what : p.presentation->notApplied)
    notes.push_back("presentation: not applied: " + what);
  if (p.frame->isColour() && p.presentation->greyscale)
    notes.push_back("presentation: not applied: grey transformations, as the image is in colour");
  if (!p.frame->isColour() && !p.presentation->greyscale)
    notes.push_back("presentation: it is for colour images; the grey values are shown as the file says");
  return notes;
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<const ImageParams>> params = imageParams(layer, context);
  if (!params) return params.error();
  const auto known = context.costs.nsPerSample.find("image.native");
  const double ns = known != context.costs.nsPerSample.end() ? known->second : kBuiltIn_ns;
  Pass pass;
  pass.name = "image " + std::to_string(index);
  pass.engine = Engine::Native;
  pass.technique = "image.native";
  pass.inputs = {"frame"};
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  pass.predicted_ms = static_cast<double>(context.view.width_px) * context.view.height_px * ns * 1e-6 /
                      std::max(1, context.capabilities.threads);
  pass.predictedError = 1e-4;  // double throughout; the float frame rounds to 2^-24
  pass.notes = notesOf(std::get<ImageLayer>(layer), **params);
  pass.params = *params;
  return std::vector<Pass>{std::move(pass)};
}

}  // namespace

double ImageParams::modalityOf(double stored) const {
  if (!presentation || !presentation->greyscale) return frame->modalityOf(stored);
  if (presentation->modalityLut) return lookUp(*presentation->modalityLut, stored);
  return presentation->rescale.slope * stored + presentation->rescale.intercept;
}

double ImageParams::greyOf(double modality) const {
  double g = voiLut ? lutGrey(*voiLut, modality) : applyVoi(window, modality);
  if (presentation && presentation->presentationLut) {
    // Its input is the whole range of the VOI's output, in whole numbers: a window's are cut off, not
    // rounded, as the field's reference implementation of display consistency does.
    const LutTable& lut = *presentation->presentationLut;
    g = lutGrey(lut, lut.firstMapped + std::floor(g * static_cast<double>(lut.data.size() - 1) + kRounding));
  }
  return std::clamp(invert ? 1.0 - g : g, 0.0, 1.0);
}

std::string ImageParams::dump() const {
  const ImageFrameInfo& info = frame->info();
  std::string s = "frame " + std::to_string(info.columns) + "x" + std::to_string(info.rows) + " at " +
                  number(picture.x0) + "," + number(picture.y0) + " zoom " + number(picture.pxPerColumn) +
                  "," + number(picture.pxPerRow) + (picture.transposed ? " transposed" : "") +
                  (interpolation == Interpolation::Linear ? " linear" : " nearest");
  if (frame->isColour())
    s += " colour";
  else
    s += voiLut ? " voi lut" : " window " + number(window.center) + "/" + number(window.width);
  if (presentation)
    s += std::string(" presentation") + (presentation->presentationLut ? " lut" : "") +
         (presentation->shutter ? " shutter" : "");
  return s + (invert ? " inverted" : "");
}

Result<std::shared_ptr<const ImageParams>> imageParams(const Layer& layer, const PlanContext& context) {
  const auto* image = std::get_if<ImageLayer>(&layer);
  if (!image) return makeError(ErrorCode::SceneInvalid, "The layer is not an image.");
  const auto found = context.sources.images.find({image->source, image->index});
  if (found == context.sources.images.end() || !found->second)
    return makeError(ErrorCode::SceneInvalid, "The frame that the image layer names is not loaded.");
  auto p = std::make_shared<ImageParams>();
  p->frame = found->second;
  const ImageFrameInfo& info = p->frame->info();
  auto presentation = presentationOf(*image, info, context.sources);
  if (!presentation) return presentation.error();
  p->presentation = std::move(*presentation);
  const FramePresentation* const f = p->presentation ? &*p->presentation : nullptr;
  p->picture = imagePicture(*image, context.scene.camera, context.view, info, f);
  if (!(std::abs(p->picture.pxPerColumn) > 0 && std::abs(p->picture.pxPerRow) > 0) ||
      !std::isfinite(p->picture.x0 + p->picture.y0 + p->picture.pxPerColumn + p->picture.pxPerRow))
    return makeError(ErrorCode::SceneInvalid, "The camera's zoom or height gives no finite picture scale.");
  p->view = context.view;
  p->interpolation = image->interpolation;
  const bool greyPipeline = f && f->greyscale && !p->frame->isColour();
  if (greyPipeline && f->presentationLut && !usable(*f->presentationLut))
    return makeError(ErrorCode::SceneInvalid, "The presentation LUT is empty or not of 1 to 16 bits.");
  if (!p->frame->isColour())
    if (Result<void> voi = chooseVoi(*image, info, *p); !voi) return voi.error();
  // One inversion in all: a presentation state says it for the image, whose photometric interpretation counts
  // no more (PS3.4 N.2.1.4); the user's own comes on top.
  p->invert = image->invert != (greyPipeline ? f->inverse : info.inverted);
  p->background = context.scene.background;
  return std::shared_ptr<const ImageParams>(std::move(p));
}

Technique nativeImageTechnique() {
  Technique t;
  t.name = "image.native";
  t.kinds = {"image"};
  t.engine = Engine::Native;
  t.passesFor = passesFor;
  t.execute = executeImage;
  return t;
}

}  // namespace vernier::mpr
