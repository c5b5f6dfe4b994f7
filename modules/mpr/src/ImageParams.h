// SPDX-License-Identifier: GPL-3.0-or-later
// What an image pass needs: made by imageParams() (ImagePlanning.cpp), read by the executor
// (NativeImage.cpp).
#pragma once
#include <memory>
#include <optional>

#include "vernier/plan/PictureGeometry.h"
#include "vernier/plan/Technique.h"

namespace vernier::mpr {

struct ImageParams final : PassParams {
  std::shared_ptr<const ImageFrame> frame;
  std::optional<FramePresentation> presentation;
  ImagePicture picture;
  View view;
  Interpolation interpolation = Interpolation::Linear;
  // Grey frames: stored -> modality (the frame's own, or the presentation state's) -> VOI -> presentation LUT
  // -> inversion. Colour frames know the inversion only.
  VoiWindow window;
  const LutTable* voiLut = nullptr;  // of the frame or of the presentation state; wins over window
  bool invert = false;
  Rgb background;
  std::string dump() const override;

  double modalityOf(double stored) const;
  double greyOf(double modality) const;  // 0..1; never NaN
};

// Bytes of a mask of the frame's pixels, row by row: 1 where a shutter covers them. `rowPerColumn`: distance
// between rows in columns. A pixel whose centre lies on an edge is seen.
std::vector<std::uint8_t> shutterMask(const Shutter&, std::int64_t columns, std::int64_t rows,
                                      double rowPerColumn);

Result<std::shared_ptr<const ImageParams>> imageParams(const Layer&, const PlanContext&);

}  // namespace vernier::mpr
