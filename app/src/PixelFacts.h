// SPDX-License-Identifier: GPL-3.0-or-later
// Facts of the stored values of one object, from its decoded frames.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vernier/study/Load.h"

namespace vernier {

struct PixelFacts {
  std::string sha256Int32le;  // of all frames, row by row, each value as little-endian int32; "" for floats
  double storedMin = 0, storedMax = 0, storedSum = 0;
  std::uint64_t paddingPixels = 0;
  // Through each frame's own rescale; the second without padding. Absent where values have no modality (a
  // modality LUT, a refused rescale, a segmentation) or all is padding.
  struct Range {
    double min = 0, max = 0;
  };
  std::optional<Range> modality, modalityValid;
  std::vector<double> probes;  // stored values of frame 0 at the places asked for
};
struct PixelPlace {
  std::uint64_t row = 0, column = 0;
};
// Of a colour image, frame 0.
struct ColourFacts {
  std::array<double, 3> rgbMean{};          // of its 8-bit picture, unscaled
  std::vector<std::vector<double>> stored;  // samples at the places asked for; an index, of palettes
  std::vector<std::array<double, 3>> rgb;   // colours there, 0..255
};
Result<ColourFacts> colourFacts(const StudySet&, std::size_t instance, const std::vector<PixelPlace>& probes);
// Decodes all frames of an image of one sample per pixel.
Result<PixelFacts> pixelFacts(const StudySet&, std::size_t instance, const std::vector<PixelPlace>& probes);

}  // namespace vernier
