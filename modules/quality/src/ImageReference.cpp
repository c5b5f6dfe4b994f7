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

// Even-odd; a point on an edge is inside.
bool insidePolygon(const std::vector<glm::dvec2>& polygon, glm::dvec2 p) {
  bool inside = false;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const glm::dvec2 a = polygon[n], b = polygon[(n + 1) % polygon.size()], ab = b - a, ap = p - a;
    const double l2 = glm::dot(ab, ab), t = l2 > 0 ? std::clamp(glm::dot(ap, ab) / l2, 0.0, 1.0) : 0;
    if (glm::length(ap - t * ab) <= 1e-9) return true;
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / ab.y * ab.x) inside = !inside;
  }
  return inside;
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
  if (!layer.presentation.empty()) {
    const auto state = sources.presentations.find(layer.presentation);
    if (state == sources.presentations.end() || !state->second)
      return makeError(ErrorCode::SceneInvalid, "The layer's presentation state is not loaded.");
    auto f = presentationFor(*state->second, r.frame_->info().sopInstanceUid, r.frame_->info().frameNumber);
    if (!f) return f.error();
    r.state_ = std::move(*f);
  }
  if (auto voi = r.takeVoi(); !voi) return voi.error();
  if (auto placed = r.place(scene.camera, view); !placed) return placed.error();
  return r;
}

bool ImageReference::greyState() const { return state_ && state_->greyscale && !isColour(); }

Result<void> ImageReference::takeVoi() {
  const ImageFrameInfo& info = frame_->info();
  if (layer_.voiLut) {
    if (*layer_.voiLut < 0 || static_cast<std::size_t>(*layer_.voiLut) >= info.voiLuts.size())
      return makeError(ErrorCode::SceneInvalid,
                       "The image has no VOI LUT number " + std::to_string(*layer_.voiLut) + ".");
    voiLut_ = info.voiLuts[static_cast<std::size_t>(*layer_.voiLut)];
  }
  window_ = !info.windows.empty() ? info.windows.front() : info.autoWindow;
  if (greyState() && !voiLut_ && !layer_.window) {
    if (state_->voiLut) {
      voiLut_ = state_->voiLut;
    } else if (state_->window) {
      window_ = *state_->window;
    } else if (info.type !=
               VoxelType::F32) {  // the identity: from the least to the greatest value that can be
      const double count = std::ldexp(1.0, static_cast<int>(info.bitsStored));
      const bool isSigned =
          info.type == VoxelType::I8 || info.type == VoxelType::I16 || info.type == VoxelType::I32;
      const double first = isSigned ? -count / 2 : 0;
      double a = state_->rescale.slope * first + state_->rescale.intercept;
      double b = state_->rescale.slope * (first + count - 1) + state_->rescale.intercept;
      if (state_->modalityLut) a = 0, b = std::ldexp(1.0, static_cast<int>(state_->modalityLut->bits)) - 1;
      window_ = {(a + b) / 2, std::max(std::abs(b - a), 1.0), VoiFunction::LinearExact, ""};
    }
  }
  if (layer_.window) window_ = *layer_.window;
  return {};
}

Result<void> ImageReference::place(const Camera& camera, const View& view) {
  const ImageFrameInfo& info = frame_->info();
  // x: distance between columns, y: between rows; the attributes list rows first.
  glm::dvec2 size(1, 1), area(static_cast<double>(info.columns), static_cast<double>(info.rows));
  bool known = plausible(info.pixelSpacing_mm.x) && plausible(info.pixelSpacing_mm.y);
  if (known) size = {info.pixelSpacing_mm.y, info.pixelSpacing_mm.x};
  middle_ = 0.5 * (area - 1.0);
  double magnified = 0;
  if (state_ && state_->area) {
    const DisplayedArea& a = *state_->area;
    if (a.pixelSpacing_mm) {
      known = plausible(a.pixelSpacing_mm->x) && plausible(a.pixelSpacing_mm->y);
      size = known ? glm::dvec2(a.pixelSpacing_mm->y, a.pixelSpacing_mm->x) : glm::dvec2(1, 1);
    } else if (a.pixelAspect) {
      const double rows = size.x * a.pixelAspect->x / a.pixelAspect->y;
      known = known && std::abs(rows / size.y - 1) <= 0.01;
      size.y = rows;
    }
    area = glm::abs(a.bottomRight - a.topLeft) + 1.0;
    middle_ = 0.5 * (a.topLeft + a.bottomRight) - 1.0;
    if (a.mode == AreaMode::Magnify) magnified = a.magnification;
  }
  // Clockwise by quarter turns: the frame's own right points right, down, left, up.
  const int quarters = state_ ? state_->rotation_deg / 90 : 0;
  glm::dvec2 right(1, 0), down(0, 1);  // of the picture, in (column, row)
  for (int n = 0; n < quarters; ++n) {
    const glm::dvec2 before = right;
    right = -down;
    down = before;
  }
  if (layer_.flipHorizontal != (state_ && state_->flipHorizontal)) right = -right;
  if (layer_.flipVertical) down = -down;
  const glm::dvec2 whole = area * size,
                   across(std::abs(glm::dot(right, whole)), std::abs(glm::dot(down, whole)));
  double perPixel = std::max(across.x / view.width_px, across.y / view.height_px);
  if (magnified > 0) perPixel = size.x / magnified;
  if (known && camera.height_mm) perPixel = *camera.height_mm / view.height_px;
  perPixel /= camera.zoom;
  if (!(perPixel > 0) || !std::isfinite(perPixel))
    return makeError(ErrorCode::SceneInvalid, "The camera's zoom or height gives no finite picture scale.");
  turn_ = glm::dmat2(perPixel * right / size, perPixel * down / size);
  // Panning moves the picture's centre right and up over the frame.
  centre_px_ = glm::dvec2(0.5 * view.width_px - camera.pan_mm.x / perPixel,
                          0.5 * view.height_px + camera.pan_mm.y / perPixel);
  rowsPerColumn_ = size.y / size.x;
  return {};
}

glm::dvec2 ImageReference::frameAt(glm::dvec2 pixel) const { return middle_ + turn_ * (pixel - centre_px_); }

std::array<glm::dvec2, 2> ImageReference::outline() const {
  const ImageFrameInfo& info = frame_->info();
  const glm::dmat2 back = glm::inverse(turn_);
  const glm::dvec2 a = centre_px_ + back * (glm::dvec2(-0.5) - middle_);
  const glm::dvec2 last(static_cast<double>(info.columns) - 0.5, static_cast<double>(info.rows) - 0.5);
  const glm::dvec2 b = centre_px_ + back * (last - middle_);
  return {glm::min(a, b), glm::max(a, b)};
}

std::vector<ImageReference::Corner> ImageReference::corners(glm::dvec2 pixel) const {
  const ImageFrameInfo& info = frame_->info();
  const glm::dvec2 p = frameAt(pixel);
  const glm::dvec2 last(static_cast<double>(info.columns - 1), static_cast<double>(info.rows - 1));
  constexpr double slack = 1e-9;
  if (p.x < -0.5 - slack || p.y < -0.5 - slack || p.x > last.x + 0.5 + slack || p.y > last.y + 0.5 + slack)
    return {};
  const bool nearest = layer_.interpolation == Interpolation::Nearest;
  const glm::dvec2 q = glm::clamp(nearest ? glm::floor(p + 0.5) : p, glm::dvec2(0), last);
  const glm::dvec2 lo = glm::floor(q), f = q - lo;
  std::vector<Corner> out;
  for (int n = 0; n < 4; ++n) {
    const double w = (n & 1 ? f.x : 1 - f.x) * (n & 2 ? f.y : 1 - f.y);
    if (w > 0)
      out.push_back(
          {static_cast<std::int64_t>(lo.x) + (n & 1), static_cast<std::int64_t>(lo.y) + (n >> 1), w});
  }
  return out;
}

std::optional<double> ImageReference::value(glm::dvec2 pixel) const {
  if (shutterGrey(pixel)) return std::nullopt;
  double sum = 0, weight = 0;
  for (const Corner& c : corners(pixel)) {
    const double stored = frame_->stored(c.column, c.row);
    if (noData(frame_->info(), stored)) continue;
    double modality = frame_->modalityOf(stored);
    if (greyState()) {
      modality = state_->rescale.slope * stored + state_->rescale.intercept;
      if (const auto& lut = state_->modalityLut) {
        const double last = static_cast<double>(lut->data.size()) - 1;
        modality = lut->data[static_cast<std::size_t>(std::clamp(stored - lut->firstMapped, 0.0, last))];
      }
    }
    sum += c.weight * modality;
    weight += c.weight;
  }
  return weight >= 1e-6 ? std::optional(sum / weight) : std::nullopt;
}

// The pixel nearest to the picture's decides; its centre on an edge counts as seen.
std::optional<double> ImageReference::shutterGrey(glm::dvec2 pixel) const {
  if (!state_ || !state_->shutter) return std::nullopt;
  const std::vector<Corner> around = corners(pixel);
  if (around.empty()) return std::nullopt;
  const ImageFrameInfo& info = frame_->info();
  const glm::dvec2 last(static_cast<double>(info.columns - 1), static_cast<double>(info.rows - 1));
  const glm::dvec2 at = frameAt(pixel), near(std::round(at.x * 1e9) / 1e9, std::round(at.y * 1e9) / 1e9);
  const glm::dvec2 p = glm::clamp(glm::floor(near + 0.5), glm::dvec2(0), last) + 1.0;
  const Shutter& s = *state_->shutter;
  bool seen = true;
  if (s.rectangle)
    seen = s.rectangle->left <= p.x && p.x <= s.rectangle->right && s.rectangle->upper <= p.y &&
           p.y <= s.rectangle->lower;
  if (s.circle)
    seen = seen && std::hypot(p.x - s.circle->centre.x, rowsPerColumn_ * (p.y - s.circle->centre.y)) <=
                       s.circle->radius * (1 + 1e-15);
  if (!s.polygon.empty()) seen = seen && insidePolygon(s.polygon, p);
  return seen ? std::nullopt : std::optional(s.grey);
}

// The colours of DICOM PS3.3 C.7.6.3.1.2, written down once more: the reference solves the standard's own
// equations, which go from RGB to YBR, where the engine has their inverse.
glm::dvec3 ImageReference::storedColour(std::int64_t column, std::int64_t row) const {
  const ImageFrameInfo& info = frame_->info();
  if (info.colour == ColourSpace::Palette) {
    const Palette& p = *info.palette;
    double entry = frame_->stored(column, row) - p.firstMapped;
    entry = std::min(std::max(entry, 0.0), static_cast<double>(p.entries.size()) - 1);
    const auto& e = p.entries[static_cast<std::size_t>(entry)];
    return glm::dvec3(e[0], e[1], e[2]) / p.fullScale;
  }
  const glm::dvec3 s(frame_->stored(column, row, 0), frame_->stored(column, row, 1),
                     frame_->stored(column, row, 2));
  const double full = std::ldexp(1.0, static_cast<int>(info.bitsStored)) - 1;
  if (info.colour == ColourSpace::Rgb) return s / full;
  const double step = std::ldexp(1.0, static_cast<int>(info.bitsStored) - 8);
  const bool partial = info.colour == ColourSpace::YbrPartial;
  // Rows: Y, CB, CR of red, green, blue. GLM takes columns.
  const glm::dmat3 ybrOfRgb = glm::transpose(
      partial
          ? glm::dmat3(.256788, .504129, .097906, -.148223, -.290993, .439216, .439216, -.367788, -.071427)
          : glm::dmat3(.2990, .5870, .1140, -.168736, -.331264, .5, .5, -.418688, -.081312));
  const glm::dvec3 offset = step * glm::dvec3(partial ? 16 : 0, 128, 128);
  return glm::clamp(glm::inverse(ybrOfRgb) * (s - offset) / full, glm::dvec3(0), glm::dvec3(1));
}

std::optional<glm::dvec3> ImageReference::colour(glm::dvec2 pixel) const {
  const std::vector<Corner> around = corners(pixel);
  if (around.empty()) return std::nullopt;
  glm::dvec3 sum(0);
  for (const Corner& c : around) sum += c.weight * storedColour(c.column, c.row);
  return layer_.invert ? 1.0 - sum : sum;
}

std::optional<glm::dvec3> ImageReference::shown(glm::dvec2 pixel, double* valueOut) const {
  if (const auto covered = shutterGrey(pixel)) return glm::dvec3(*covered);
  if (isColour()) return colour(pixel);
  const auto v = value(pixel);
  if (!v) return std::nullopt;
  *valueOut = *v;
  return glm::dvec3(grey(*v));
}

bool ImageReference::covers(glm::dvec2 pixel) const {
  double ignored = 0;
  return shown(pixel, &ignored).has_value();
}

double ImageReference::grey(double modality) const {
  double g = std::clamp(voiLut_ ? lutGrey(*voiLut_, modality) : windowGrey(window_, modality), 0.0, 1.0);
  bool inverted = frame_->info().inverted;
  if (greyState()) {
    inverted = state_->inverse;
    if (const auto& lut = state_->presentationLut) {
      const double last = static_cast<double>(lut->data.size()) - 1;
      g = lut->data[static_cast<std::size_t>(g * last + 1e-6)] /
          (std::ldexp(1.0, static_cast<int>(lut->bits)) - 1);
    }
  }
  return layer_.invert != inverted ? 1 - g : g;
}

}  // namespace vernier::quality
