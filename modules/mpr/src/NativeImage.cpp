// SPDX-License-Identifier: GPL-3.0-or-later
// image.native: one stored frame, unresampled but for the display zoom. Grey: stored value -> modality (slope
// or LUT) -> zoom (nearest, or bilinear of modality values, renormalised next to no-data) -> VOI (window or
// LUT, PS3.3 C.11.2) -> presentation LUT -> inversion. Colour: stored samples -> RGB -> zoom, channel by
// channel
// -> inversion. In double. A line is a row of the frame, or a column where the picture is turned by 90
// degrees.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "ImageParams.h"
#include "ImageSampling.h"
#include "SliceParams.h"
#include "vernier/base/Threads.h"

namespace vernier::mpr {
namespace {

// Less valid weight than this comes from rounding only.
constexpr double kLeastWeight = 1e-6;

// Modality value at a pixel, NaN = no data; above and below are the two lines beside it.
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

// What all rows of a picture share.
struct Drawing {
  const ImageParams& p;
  Images& images;
  std::vector<Beside> xs, ys;         // along the picture's rows and columns
  std::vector<std::uint8_t> mask;     // of the frame's pixels, empty without a shutter
  std::int64_t first = 0, last = -1;  // the places of a line that the picture shows

  // Places along a line and the line's own number, as column and row of the frame.
  glm::i64vec2 place(std::int64_t along, std::int64_t line) const {
    return p.picture.transposed ? glm::i64vec2(line, along) : glm::i64vec2(along, line);
  }
  bool covered(const Beside& x, const Beside& y) const {
    if (mask.empty()) return false;
    const auto nearest = [](const Beside& b) { return b.t < 0.5 ? b.first : b.second; };
    const glm::i64vec2 at = place(nearest(x), nearest(y));
    return mask[static_cast<std::size_t>(at.x + p.frame->info().columns * at.y)] != 0;
  }
};

void putPixel(Images& images, std::size_t n, const glm::dvec3& rgb, bool data, double value) {
  for (int c = 0; c < 3; ++c) images.colour[4 * n + static_cast<std::size_t>(c)] = static_cast<float>(rgb[c]);
  images.colour[4 * n + 3] = 1.0f;
  images.depth[n] = data ? 0.0f : kNothing_mm;
  if (!images.values.empty()) images.values[n] = static_cast<float>(value);
}

// The modality values of the frame's lines, NaN = no data.
auto greyLines(const Drawing& d) {
  const auto fill = [&d](std::int64_t line, double* out) {
    const ImageFrame& frame = *d.p.frame;
    for (std::int64_t i = d.first; i <= d.last; ++i) {
      const glm::i64vec2 at = d.place(i, line);
      const double stored = frame.stored(at.x, at.y);
      out[i] = frame.isNoData(stored) ? std::numeric_limits<double>::quiet_NaN() : d.p.modalityOf(stored);
    }
  };
  return KeptLines<double, decltype(fill)>(d.last, fill);
}

auto colourLines(const Drawing& d) {
  const auto fill = [&d](std::int64_t line, glm::dvec3* out) {
    const ImageFrame& frame = *d.p.frame;
    if (!d.p.picture.transposed && d.first <= d.last)
      frame.rgbRow(line, d.first, d.last, out + d.first);
    else
      for (std::int64_t i = d.first; i <= d.last; ++i) out[i] = frame.rgb(line, i);
  };
  return KeptLines<glm::dvec3, decltype(fill)>(d.last, fill);
}

struct Pixel {
  glm::dvec3 rgb;
  bool data;
  double value;
};

Pixel pixelOf(const ImageParams& p, const double* above, const double* below, const Beside& x,
              const Beside& y) {
  const double value = valueAt(above, below, x, y);
  if (std::isnan(value)) return {{p.background.r, p.background.g, p.background.b}, false, value};
  return {glm::dvec3(p.greyOf(value)), true, value};
}

Pixel pixelOf(const ImageParams& p, const glm::dvec3* above, const glm::dvec3* below, const Beside& x,
              const Beside& y) {
  const glm::dvec3 rgb = (1 - y.t) * ((1 - x.t) * above[x.first] + x.t * above[x.second]) +
                         y.t * ((1 - x.t) * below[x.first] + x.t * below[x.second]);
  return {p.invert ? 1.0 - rgb : rgb, true, std::numeric_limits<double>::quiet_NaN()};
}

// Returns the number of pixels that lay in the frame.
template <class Lines>
std::uint64_t drawRow(const Drawing& d, Lines& lines, std::size_t y) {
  const ImageParams& p = d.p;
  const Beside& row = d.ys[y];
  const glm::dvec3 background(p.background.r, p.background.g, p.background.b);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const auto* above = row.first >= 0 ? lines.line(row.first) : nullptr;
  const auto* below = row.first >= 0 ? lines.line(row.second) : nullptr;
  std::uint64_t samples = 0;
  for (std::size_t x = 0; x < d.xs.size(); ++x) {
    const bool inside = row.first >= 0 && d.xs[x].first >= 0;
    samples += inside ? 1 : 0;
    Pixel pixel{background, false, kNaN};
    if (inside && d.covered(d.xs[x], row))
      pixel = {glm::dvec3(p.presentation->shutter->grey), true, kNaN};
    else if (inside)
      pixel = pixelOf(p, above, below, d.xs[x], row);
    putPixel(d.images, y * d.xs.size() + x, pixel.rgb, pixel.data, pixel.value);
  }
  return samples;
}

Drawing drawingOf(const ImageParams& p, Images& images) {
  const ImageFrameInfo& info = p.frame->info();
  const ImagePicture& at = p.picture;
  const bool nearest = p.interpolation == Interpolation::Nearest, turned = at.transposed;
  Drawing d{p, images, {}, {}, {}};
  d.xs = besides(p.view.width_px, at.x0, turned ? at.pxPerRow : at.pxPerColumn,
                 turned ? info.rows : info.columns, nearest);
  d.ys = besides(p.view.height_px, at.y0, turned ? at.pxPerColumn : at.pxPerRow,
                 turned ? info.columns : info.rows, nearest);
  d.first = turned ? info.rows : info.columns;
  for (const Beside& b : d.xs)
    if (b.first >= 0) d.first = std::min(d.first, b.first), d.last = std::max(d.last, b.second);
  if (p.presentation && p.presentation->shutter)
    d.mask = shutterMask(*p.presentation->shutter, info.columns, info.rows,
                         std::abs(at.pxPerRow / at.pxPerColumn));
  return d;
}

}  // namespace

Result<void> executeImage(const Pass& pass, Images& images, std::stop_token stop) {
  const auto* p = dynamic_cast<const ImageParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no image parameters.", "image.native");
  fitImages(images, p->view);
  const Drawing d = drawingOf(*p, images);
  std::atomic<std::uint64_t> samples{0};
  const auto draw = [&](std::size_t begin, std::size_t end, auto lines) {
    std::uint64_t drawn = 0;
    for (std::size_t y = begin; y < end && !stop.stop_requested(); ++y) drawn += drawRow(d, lines, y);
    samples += drawn;
  };
  parallelFor(d.ys.size(), 32, [&](std::size_t begin, std::size_t end) {
    if (p->frame->isColour())
      draw(begin, end, colourLines(d));
    else
      draw(begin, end, greyLines(d));
  });
  images.counters.samples += samples;
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The image was cancelled.");
  return {};
}

}  // namespace vernier::mpr
