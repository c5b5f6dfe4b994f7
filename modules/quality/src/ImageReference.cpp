// SPDX-License-Identifier: GPL-3.0-or-later
#include "ImageReference.h"

#include <algorithm>
#include <cmath>

#include "Grey.h"

namespace vernier::quality {
namespace {

// Below 0.1 um or above 1 m a spacing is a mistake of the file, and lengths are not known.
bool plausible(double mm) { return mm >= 1e-4 && mm <= 1e3; }

bool noData(const ImageFrameInfo& info, double stored) {
  return std::isnan(stored) || (info.noData && stored >= info.noData->first && stored <= info.noData->last);
}

}  // namespace

Result<ImageReference> ImageReference::make(const Scene& scene, const ImageLayer& layer, const View& view,
                                            const Sources& sources) {
  const auto found = sources.images.find({layer.source, layer.index});
  if (found == sources.images.end() || !found->second)
    return makeError(ErrorCode::SceneInvalid, "Frame " + std::to_string(layer.index) +
                                                  " of the layer's image '" + layer.source +
                                                  "' is not loaded.");
  ImageReference r;
  r.frame_ = found->second;
  r.layer_ = layer;
  const ImageFrameInfo& info = r.frame_->info();
  if (layer.voiLut && (*layer.voiLut < 0 || static_cast<std::size_t>(*layer.voiLut) >= info.voiLuts.size()))
    return makeError(ErrorCode::SceneInvalid,
                     "The image has no VOI LUT number " + std::to_string(*layer.voiLut) + ".");
  r.window_ = layer.window ? *layer.window : !info.windows.empty() ? info.windows.front() : info.autoWindow;

  const bool known = plausible(info.pixelSpacing_mm.x) && plausible(info.pixelSpacing_mm.y);
  // x: distance between columns, y: between rows; the attribute lists rows first.
  const glm::dvec2 size =
      known ? glm::dvec2(info.pixelSpacing_mm.y, info.pixelSpacing_mm.x) : glm::dvec2(1, 1);
  const glm::dvec2 whole =
      size * glm::dvec2(static_cast<double>(info.columns), static_cast<double>(info.rows));
  const Camera& camera = scene.camera;
  double perPixel = std::max(whole.x / view.width_px, whole.y / view.height_px);
  if (known && camera.height_mm) perPixel = *camera.height_mm / view.height_px;
  perPixel /= camera.zoom;
  if (!(perPixel > 0) || !std::isfinite(perPixel))
    return makeError(ErrorCode::SceneInvalid, "The camera's zoom or height gives no finite picture scale.");
  r.pxPerSample_ = size / perPixel;
  // Panning moves the picture's centre right and up over the frame.
  r.centre_px_ = glm::dvec2(0.5 * view.width_px - camera.pan_mm.x / perPixel,
                            0.5 * view.height_px + camera.pan_mm.y / perPixel);
  return r;
}

glm::dvec2 ImageReference::frameAt(glm::dvec2 pixel) const {
  const ImageFrameInfo& info = frame_->info();
  glm::dvec2 d = (pixel - centre_px_) / pxPerSample_;
  if (layer_.flipHorizontal) d.x = -d.x;
  if (layer_.flipVertical) d.y = -d.y;
  return d + 0.5 * glm::dvec2(static_cast<double>(info.columns - 1), static_cast<double>(info.rows - 1));
}

glm::dvec2 ImageReference::least() const {
  const ImageFrameInfo& info = frame_->info();
  return centre_px_ -
         0.5 * pxPerSample_ * glm::dvec2(static_cast<double>(info.columns), static_cast<double>(info.rows));
}

glm::dvec2 ImageReference::greatest() const { return 2.0 * centre_px_ - least(); }

std::optional<double> ImageReference::value(glm::dvec2 pixel) const {
  const ImageFrameInfo& info = frame_->info();
  const glm::dvec2 p = frameAt(pixel);
  const glm::dvec2 last(static_cast<double>(info.columns - 1), static_cast<double>(info.rows - 1));
  constexpr double slack = 1e-9;
  if (p.x < -0.5 - slack || p.y < -0.5 - slack || p.x > last.x + 0.5 + slack || p.y > last.y + 0.5 + slack)
    return std::nullopt;
  const bool nearest = layer_.interpolation == Interpolation::Nearest;
  const glm::dvec2 q = glm::clamp(nearest ? glm::floor(p + 0.5) : p, glm::dvec2(0), last);
  const glm::dvec2 lo = glm::floor(q), f = q - lo;
  double sum = 0, weight = 0;
  for (int n = 0; n < 4; ++n) {
    const double w = (n & 1 ? f.x : 1 - f.x) * (n & 2 ? f.y : 1 - f.y);
    if (!(w > 0)) continue;
    const auto column = static_cast<std::int64_t>(lo.x) + (n & 1),
               row = static_cast<std::int64_t>(lo.y) + (n >> 1);
    if (noData(info, frame_->stored(column, row))) continue;
    sum += w * frame_->modality(column, row);
    weight += w;
  }
  return weight >= 1e-6 ? std::optional(sum / weight) : std::nullopt;
}

double ImageReference::grey(double modality) const {
  const ImageFrameInfo& info = frame_->info();
  const double g = layer_.voiLut ? lutGrey(info.voiLuts[static_cast<std::size_t>(*layer_.voiLut)], modality)
                                 : windowGrey(window_, modality);
  return layer_.invert != info.inverted ? 1 - g : g;
}

}  // namespace vernier::quality
