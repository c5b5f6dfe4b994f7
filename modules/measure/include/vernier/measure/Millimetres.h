// SPDX-License-Identifier: GPL-3.0-or-later
// Which mm a stored frame has: docs/measurements.md, "Which millimetres". Never a guess: without a rule,
// pixels.
#pragma once
#include <optional>
#include <span>

#include "vernier/measure/Measured.h"
#include "vernier/measure/Measurement.h"
#include "vernier/volume/ImageCalibration.h"
#include "vernier/volume/ImageFrame.h"

namespace vernier::measure {

struct PixelScale {
  glm::dvec2 perPixel{1, 1};  // x: between neighbouring columns, y: between neighbouring rows; in `unit`
  const char* unit = "px";    // or "mm"
  Origin origin = Origin::Pixels;
  std::string text = "px";
};

// For a measurement with these points (image space): an ultrasound region counts only when all of them lie in
// it.
VERNIER_API PixelScale pixelScaleOf(const ImageFrameInfo&, const PixelCalibration&,
                                    std::span<const Spot> points,
                                    const std::optional<glm::dvec2>& userSpacing_mm);

// Of a volume file: File; Pixels where it states no spacing, so that the 1 mm that was taken is none.
struct FileScale {
  Origin origin = Origin::File;
  std::string text = "mm (spacing of the file)";
};
VERNIER_API FileScale fileScaleOf(std::span<const Finding>);

}  // namespace vernier::measure
