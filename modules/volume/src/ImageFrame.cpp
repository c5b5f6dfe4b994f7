// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/ImageFrame.h"

#include <cmath>
#include <utility>

#include "Range.h"
#include "VoxelAccess.h"
#include "vernier/base/Checked.h"
#include "vernier/base/Guarded.h"
#include "vernier/volume/Colour.h"
#include "vernier/volume/Voi.h"

namespace vernier {

Result<std::shared_ptr<const ImageFrame>> ImageFrame::make(ImageFrameInfo info, Buffer pixels) {
  if (info.columns < 1 || info.rows < 1)
    return makeError(ErrorCode::PixelDescriptionInvalid, "An image needs at least one row and one column.");
  const auto need =
      checkedProduct({static_cast<std::uint64_t>(info.columns), static_cast<std::uint64_t>(info.rows),
                      static_cast<std::uint64_t>(info.samples()), bytesOf(info.type)});
  if (!need || *need != pixels.size())
    return makeError(ErrorCode::PixelDataShort, "The image needs " + std::to_string(need.value_or(0)) +
                                                    " bytes of pixels and got " +
                                                    std::to_string(pixels.size()) + ".");
  if (!std::isfinite(info.rescale.slope) || info.rescale.slope == 0 || !std::isfinite(info.rescale.intercept))
    return makeError(ErrorCode::RescaleInvalid,
                     "The rescale slope is 0 or not finite; stored values can be shown unscaled instead.");
  if (info.colour == ColourSpace::Palette && (!info.palette || info.palette->entries.empty()))
    return makeError(ErrorCode::PixelDescriptionInvalid,
                     "The image is of palette colours but has no palette.");
  if (info.modalityLut && info.modalityLut->data.empty())
    return makeError(ErrorCode::PixelDescriptionInvalid, "The modality LUT has no entries.");
  return guarded("ImageFrame::make", [&]() -> Result<std::shared_ptr<const ImageFrame>> {
    cleanFloats(info.type, pixels.data(),
                static_cast<std::size_t>(info.columns * info.rows * info.samples()));
    std::shared_ptr<ImageFrame> f(new ImageFrame);
    f->info_ = std::move(info);
    f->pixels_ = std::move(pixels);
    f->revision_ = nextRevision();
    return std::shared_ptr<const ImageFrame>(std::move(f));
  });
}

double ImageFrame::stored(std::int64_t column, std::int64_t row, std::int64_t sample) const {
  return storedAt(info_.type, pixels_.data(),
                  static_cast<std::size_t>((column + info_.columns * row) * info_.samples() + sample));
}

void ImageFrame::rgbRow(std::int64_t row, std::int64_t first, std::int64_t last, glm::dvec3* out) const {
  withVoxels(info_.type, pixels_.data(), [&](const auto* v) {
    const std::int64_t n = info_.samples();
    const auto* pixel = v + (first + info_.columns * row) * n;
    for (std::int64_t i = first; i <= last; ++i, pixel += n) {
      std::array<double, 3> s{};
      for (std::int64_t c = 0; c < n; ++c) s[static_cast<std::size_t>(c)] = static_cast<double>(pixel[c]);
      *out++ = rgbOf(info_.colour, s, info_.bitsStored, info_.palette.get());
    }
  });
}

glm::dvec3 ImageFrame::rgb(std::int64_t column, std::int64_t row) const {
  glm::dvec3 out;
  rgbRow(row, column, column, &out);
  return out;
}

double ImageFrame::modalityOf(double storedValue) const {
  if (info_.modalityLut) return lookUp(*info_.modalityLut, storedValue);
  return info_.rescale.slope * storedValue + info_.rescale.intercept;
}

double ImageFrame::modality(std::int64_t column, std::int64_t row) const {
  return modalityOf(stored(column, row));
}

}  // namespace vernier
