// SPDX-License-Identifier: GPL-3.0-or-later
// ImageFrame: one stored frame, unresampled, in the file's own row and column directions; needs no geometry.
// One grey value per pixel, or a colour: a palette index, or three samples interleaved by pixel. Windows,
// padding and modality values are for grey frames only.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vernier/volume/Volume.h"

namespace vernier {

struct ImageFrameInfo {
  std::int64_t columns = 0, rows = 0;
  VoxelType type = VoxelType::I16;
  ColourSpace colour = ColourSpace::Grey;
  std::uint32_t bitsStored = 16;           // the full scale of a colour sample is 2^bits - 1
  std::shared_ptr<const Palette> palette;  // of ColourSpace::Palette
  std::int64_t samples() const {
    return colour == ColourSpace::Grey || colour == ColourSpace::Palette ? 1 : 3;
  }
  ModalityRescale rescale;
  std::optional<LutTable> modalityLut;
  std::optional<NoDataRange> noData;
  std::vector<VoiWindow> windows;
  std::vector<LutTable> voiLuts;
  VoiWindow autoWindow;  // 1st..99th percentile of the stack without padding; used when there is no other
  bool inverted = false;
  bool unscaled = false;
  std::string modality, unit = "stored value";
  std::optional<FramePlane> plane;  // for letters and lengths
  std::string patientOrientation;
  glm::dvec2 pixelSpacing_mm{0, 0};   // row\column; 0 = unknown, lengths in px
  std::int64_t index = 0, count = 1;  // place in its stack
  std::string sopInstanceUid;         // of its object, "" where it is of none
  std::int64_t frameNumber = 1;       // in its object, from 1
  std::string title;
  std::vector<Finding> findings;
};

class VERNIER_API ImageFrame {
 public:
  // PixelDataShort, PixelDescriptionInvalid or RescaleInvalid when info and pixels don't fit each other.
  static Result<std::shared_ptr<const ImageFrame>> make(ImageFrameInfo info, Buffer pixels);
  ImageFrame(const ImageFrame&) = delete;
  ImageFrame& operator=(const ImageFrame&) = delete;
  const ImageFrameInfo& info() const { return info_; }
  const std::byte* data() const { return pixels_.data(); }
  bool isColour() const { return vernier::isColour(info_.colour); }
  double stored(std::int64_t column, std::int64_t row, std::int64_t sample = 0) const;
  // The colour of a pixel of a colour frame, display-referred 0..1.
  glm::dvec3 rgb(std::int64_t column, std::int64_t row) const;
  // `rgb` of a row's pixels [first, last] to out[0], out[1]...
  void rgbRow(std::int64_t row, std::int64_t first, std::int64_t last, glm::dvec3* out) const;
  double modality(std::int64_t column, std::int64_t row) const;  // through slope or modality LUT
  double modalityOf(double stored) const;
  bool isNoData(double storedValue) const {
    return storedValue != storedValue ||
           (info_.noData && storedValue >= info_.noData->first && storedValue <= info_.noData->last);
  }
  Revision revision() const { return revision_; }

 private:
  ImageFrame() = default;
  ImageFrameInfo info_;
  Buffer pixels_;
  Revision revision_ = 0;
};

}  // namespace vernier
