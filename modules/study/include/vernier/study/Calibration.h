// SPDX-License-Identifier: GPL-3.0-or-later
// What an object says of the size of its pixels beside Pixel Spacing: PS3.3 C.8.5.5 (ultrasound
// regions), 10.7.1.3 (calibration), C.8.7.5 and C.8.11.4 (detector, magnification), C.8.6.2 (film), C.7.6.3
// (aspect ratio). Asked for when something is measured, so that a scan keeps nothing of it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"

namespace vernier {

struct StudySet;

// A region of an ultrasound image with units of its own. Pixels count from 0, the box includes its last
// column and row.
struct UltrasoundRegion {
  std::int64_t firstColumn = 0, firstRow = 0, lastColumn = 0, lastRow = 0;
  std::uint16_t unitsX = 0, unitsY = 0;  // 3 = cm
  double deltaX = 0, deltaY = 0;         // units for each column and each row, signed as in the file
};

// Finite and, but for the regions' parts, above 0; absent where the object says nothing or nothing usable.
// Pairs are row\column: x = distance between rows.
struct PixelCalibration {
  std::optional<glm::dvec2> imagerSpacing_mm;       // (0018,1164): at the detector's front plane
  std::optional<glm::dvec2> filmSpacing_mm;         // (0018,2010): of digitised film
  std::optional<glm::dvec2> aspectRatio;            // (0028,0034): vertical\horizontal
  std::optional<double> radiographicMagnification;  // (0018,1114)
  std::string calibrationType;                      // (0028,0A02): GEOMETRY or FIDUCIAL
  bool secondaryCapture = false;                    // of a Secondary Capture class, whatever its modality
  std::vector<UltrasoundRegion> regions;
};

// Of StudySet::instances[instance]; reads the header of its file again, with the errors of reading.
VERNIER_API Result<PixelCalibration> pixelCalibration(const StudySet&, std::size_t instance);

}  // namespace vernier
