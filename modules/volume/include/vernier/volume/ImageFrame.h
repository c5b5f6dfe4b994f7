// SPDX-License-Identifier: GPL-3.0-or-later
// ImageFrame: one stored frame, unresampled, in the file's own row and column directions; needs no geometry.
// Stored values are kept as double-exact floats per sample type; one sample per pixel in this version (colour
// is listed, not drawn).
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
  double stored(std::int64_t column, std::int64_t row) const;
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
