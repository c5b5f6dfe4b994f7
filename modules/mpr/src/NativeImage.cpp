// SPDX-License-Identifier: GPL-3.0-or-later
// image.native: one stored frame, unresampled but for the display zoom. Stored value -> modality (slope or
// LUT) -> zoom (nearest, or bilinear of modality values, renormalised next to no-data) -> VOI (window or LUT,
// PS3.3 C.11.2)
// -> inversion. In double.
#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>

#include "SliceParams.h"
#include "vernier/base/Threads.h"
#include "vernier/volume/Voi.h"

namespace vernier::mpr {
namespace {

constexpr double kBuiltIn_ns = 25.0;
// A picture's edge that falls on a pixel centre stays in, whatever its rounding.
constexpr double kEdge = 1e-9;
// Less valid weight than this comes from rounding only.
constexpr double kLeastWeight = 1e-6;

struct ImageParams final : PassParams {
  std::shared_ptr<const ImageFrame> frame;
  ImagePicture picture;
  View view;
  Interpolation interpolation = Interpolation::Linear;
  VoiWindow window;
  const LutTable* voiLut = nullptr;  // of the frame
  bool invert = false;
  Rgb background;
  std::string dump() const override;
};

std::string number(double v) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::general, 6);
  return std::string(text, end.ptr);
}

std::string ImageParams::dump() const {
  const ImageFrameInfo& info = frame->info();
  std::string s = "frame " + std::to_string(info.columns) + "x" + std::to_string(info.rows) + " at " +
                  number(picture.x0) + "," + number(picture.y0) + " zoom " + number(picture.pxPerColumn) +
                  "," + number(picture.pxPerRow) +
                  (interpolation == Interpolation::Linear ? " linear" : " nearest");
  s += voiLut ? " voi lut" : " window " + number(window.center) + "/" + number(window.width);
  return s + (invert ? " inverted" : "");
}

// Entry of a VOI LUT, scaled to 0..1; values outside take the first or last entry.
double lutGrey(const LutTable& lut, double modality) {
  const double last = static_cast<double>(lut.data.size() - 1);
  const double entry = std::clamp(std::floor(modality - lut.firstMapped + 0.5), 0.0, last);
  return static_cast<double>(lut.data[static_cast<std::size_t>(entry)]) / (std::exp2(lut.bits) - 1.0);
}

double greyOf(const ImageParams& p, double modality) {
  const double g = p.voiLut ? lutGrey(*p.voiLut, modality) : applyVoi(p.window, modality);
  return std::clamp(p.invert ? 1.0 - g : g, 0.0, 1.0);
}

bool isNoData(const ImageFrameInfo& info, double stored) {
  return std::isnan(stored) || (info.noData && stored >= info.noData->first && stored <= info.noData->last);
}

// One direction of the picture: which two samples of the frame lie beside a pixel, and the weight of the
// second.
struct Beside {
  std::int64_t first = -1, second = -1;  // -1: outside
  double t = 0;
};

std::vector<Beside> besides(int pixels, double start_px, double pxPerSample, std::int64_t n, bool nearest) {
  std::vector<Beside> out(static_cast<std::size_t>(pixels));
  const double last = static_cast<double>(n - 1);
  for (int i = 0; i < pixels; ++i) {
    const double at = (i + 0.5 - start_px) / pxPerSample - 0.5;
    if (!(at >= -0.5 - kEdge && at <= last + 0.5 + kEdge)) continue;
    // Rounding of the zoom must not turn a pixel centre into a blend with its neighbour.
    const double snapped = std::abs(at - std::nearbyint(at)) < kEdge ? std::nearbyint(at) : at;
    const double held = std::clamp(nearest ? std::floor(snapped + 0.5) : snapped, 0.0, last);
    Beside& b = out[static_cast<std::size_t>(i)];
    b.first = static_cast<std::int64_t>(std::floor(held));
    b.second = std::min(b.first + 1, n - 1);
    b.t = held - std::floor(held);
  }
  return out;
}

// Modality values of the frame's rows, NaN = no data, each row converted once while neighbouring picture rows
// need it.
class ModalityRows {
 public:
  // Only columns [first, last] will be asked for.
  ModalityRows(const ImageFrame& frame, std::int64_t first, std::int64_t last)
      : frame_(frame), first_(first), last_(last) {}

  // Valid until the row after next is asked for.
  const double* row(std::int64_t j) {
    for (const Kept& k : kept_)
      if (k.row == j) return k.values.data();
    Kept& k = kept_[next_];
    next_ = 1 - next_;
    k.row = j;
    k.values.resize(static_cast<std::size_t>(last_ + 1));
    for (std::int64_t i = first_; i <= last_; ++i) {
      const double stored = frame_.stored(i, j);
      k.values[static_cast<std::size_t>(i)] = isNoData(frame_.info(), stored)
                                                  ? std::numeric_limits<double>::quiet_NaN()
                                                  : frame_.modalityOf(stored);
    }
    return k.values.data();
  }

 private:
  struct Kept {
    std::int64_t row = -1;
    std::vector<double> values;
  };
  const ImageFrame& frame_;
  std::int64_t first_, last_;
  Kept kept_[2];
  std::size_t next_ = 0;
};

// Modality value at a pixel, NaN = no data; above and below are the two rows beside it.
double valueAt(const double* above, const double* below, const Beside& x, const Beside& y) {
  const double corner[4] = {above[x.first], above[x.second], below[x.first], below[x.second]};
  const double weight[4] = {(1 - x.t) * (1 - y.t), x.t * (1 - y.t), (1 - x.t) * y.t, x.t * y.t};
  const double all =
      corner[0] * weight[0] + corner[1] * weight[1] + corner[2] * weight[2] + corner[3] * weight[3];
  if (!std::isnan(all)) return all;
  double sum = 0, valid = 0;  // next to no-data: over the corners that have a value
  for (int c = 0; c < 4; ++c) {
    if (!(weight[c] > 0) || std::isnan(corner[c])) continue;
    sum += weight[c] * corner[c];
    valid += weight[c];
  }
  return valid >= kLeastWeight ? sum / valid : std::numeric_limits<double>::quiet_NaN();
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
  p->picture = imagePicture(*image, context.scene.camera, context.view, *p->frame);
  if (!(std::abs(p->picture.pxPerColumn) > 0 && std::abs(p->picture.pxPerRow) > 0) ||
      !std::isfinite(p->picture.x0 + p->picture.y0 + p->picture.pxPerColumn + p->picture.pxPerRow))
    return makeError(ErrorCode::SceneInvalid, "The camera's zoom or height gives no finite picture scale.");
  p->view = context.view;
  p->interpolation = image->interpolation;
  p->window = normalised(image->window           ? *image->window
                         : !info.windows.empty() ? info.windows.front()
                                                 : info.autoWindow);
  if (image->voiLut) {
    const auto n = static_cast<std::size_t>(*image->voiLut);
    if (*image->voiLut < 0 || n >= info.voiLuts.size())
      return makeError(ErrorCode::SceneInvalid,
                       "The image has no VOI LUT number " + std::to_string(*image->voiLut) + ".");
    p->voiLut = &info.voiLuts[n];
    if (p->voiLut->data.empty() || p->voiLut->bits < 1 || p->voiLut->bits > 16)
      return makeError(ErrorCode::SceneInvalid, "The VOI LUT is empty or not of 1 to 16 bits.");
  } else if (!usableWindow(p->window)) {
    return makeError(ErrorCode::SceneInvalid, "The window's width must be above 0 and its numbers finite.");
  }
  p->invert = image->invert != info.inverted;
  p->background = context.scene.background;
  return std::shared_ptr<const ImageParams>(std::move(p));
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
  pass.params = *params;
  return std::vector<Pass>{std::move(pass)};
}

// Draws row y, returns the number of pixels that lay in the frame.
std::uint64_t drawRow(const ImageParams& p, ModalityRows& rows, Images& images, std::size_t y,
                      const std::vector<Beside>& xs, const Beside& row) {
  const float background[3] = {static_cast<float>(p.background.r), static_cast<float>(p.background.g),
                               static_cast<float>(p.background.b)};
  std::uint64_t samples = 0;
  const double* above = row.first >= 0 ? rows.row(row.first) : nullptr;
  const double* below = row.first >= 0 ? rows.row(row.second) : nullptr;
  for (std::size_t x = 0; x < xs.size(); ++x) {
    const bool inside = row.first >= 0 && xs[x].first >= 0;
    samples += inside ? 1 : 0;
    const double value =
        inside ? valueAt(above, below, xs[x], row) : std::numeric_limits<double>::quiet_NaN();
    const bool data = !std::isnan(value);
    const float grey = data ? static_cast<float>(greyOf(p, value)) : 0.0f;
    const std::size_t n = y * xs.size() + x;
    for (std::size_t c = 0; c < 3; ++c) images.colour[4 * n + c] = data ? grey : background[c];
    images.colour[4 * n + 3] = 1.0f;
    images.depth[n] = data ? 0.0f : kNothing_mm;
    if (!images.values.empty()) images.values[n] = static_cast<float>(value);
  }
  return samples;
}

Result<void> execute(const Pass& pass, Images& images, std::stop_token stop) {
  const auto* p = dynamic_cast<const ImageParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no image parameters.", "image.native");
  fitImages(images, p->view);
  const ImageFrameInfo& info = p->frame->info();
  const bool nearest = p->interpolation == Interpolation::Nearest;
  const auto xs = besides(p->view.width_px, p->picture.x0, p->picture.pxPerColumn, info.columns, nearest);
  const auto ys = besides(p->view.height_px, p->picture.y0, p->picture.pxPerRow, info.rows, nearest);
  std::atomic<std::uint64_t> samples{0};
  std::int64_t first = info.columns, last = -1;  // the columns that the picture shows
  for (const Beside& b : xs)
    if (b.first >= 0) first = std::min(first, b.first), last = std::max(last, b.second);
  parallelFor(ys.size(), 32, [&](std::size_t begin, std::size_t end) {
    ModalityRows rows(*p->frame, first, last);
    std::uint64_t drawn = 0;
    for (std::size_t y = begin; y < end && !stop.stop_requested(); ++y)
      drawn += drawRow(*p, rows, images, y, xs, ys[y]);
    samples += drawn;
  });
  images.counters.samples += samples;
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The image was cancelled.");
  return {};
}

}  // namespace

Technique nativeImageTechnique() {
  Technique t;
  t.name = "image.native";
  t.kinds = {"image"};
  t.engine = Engine::Native;
  t.passesFor = passesFor;
  t.execute = execute;
  return t;
}

}  // namespace vernier::mpr
