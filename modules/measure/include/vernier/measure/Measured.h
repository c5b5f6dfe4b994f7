// SPDX-License-Identifier: GPL-3.0-or-later
// What a measurement says: values with unit, +/- and the origin of its millimetres.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"

namespace vernier::measure {

// Where millimetres come from, in the order of the rules (docs/measurements.md). Pixels: there are none.
enum class Origin {
  Pixels,            // "px"
  SquaredPixels,     // px of the columns' width; the rows scaled by Pixel Aspect Ratio
  PixelSpacing,      // CT, MR, PT, NM and what has a place in the patient
  UltrasoundRegion,  // physical units of one region
  Calibrated,        // projection, Pixel Spacing that was calibrated
  AtDetector,        // projection, Imager Pixel Spacing
  Magnified,         // the same divided by the magnification that the file estimates
  Film,              // digitised film
  User,              // the user's own calibration
  File,              // a volume file's spacing
};
VERNIER_API const char* nameOf(Origin);

struct Quantity {
  std::string name;  // "length", "area", "mean"...
  double value = 0;
  std::string unit;                // "mm", "px", "deg", "mm2", "px2", "mm3", the unit of values, "1"
  std::optional<double> expanded;  // +/-, k = 2; nullopt: none is stated
  friend bool operator==(const Quantity&, const Quantity&) = default;
};

// "52.3 ± 0.5 mm": the +/- rounded up to one digit, the value to the same place, so that no digit is finer
// than it. Without one: six digits. The same in every locale.
VERNIER_API std::string displayText(const Quantity&);
// Another value of the same kind, such as the SD beside a mean: to the place that the quantity is shown to,
// with its unit left out.
VERNIER_API std::string displayLike(double value, const Quantity&);

struct Histogram {
  double first = 0, width = 0;  // bin n: first + n width <= x < first + (n + 1) width, the last one closed
  std::vector<std::uint64_t> counts;
  friend bool operator==(const Histogram&, const Histogram&) = default;
};

// Of modality values, computed in double from stored ones.
struct Statistics {
  std::uint64_t n = 0;       // pixels, voxels or samples with data
  std::uint64_t noData = 0;  // left out: padding, outside, in a gap
  double min = 0, max = 0, mean = 0, median = 0;
  std::optional<double> sd;  // of n - 1; nullopt for n = 1
  double effective = 0;      // n that counts for the mean's +/-: fewer where neighbours are alike
  Histogram histogram;
  friend bool operator==(const Statistics&, const Statistics&) = default;
};

struct Measured {
  std::vector<Quantity> quantities;  // the first one stands beside the drawing; empty: arrow, text
  Origin origin = Origin::Pixels;
  std::string originText;  // "mm (calibrated: FIDUCIAL)"
  std::optional<Statistics> values;
  std::vector<std::string> notes;  // "interpolated", "projected length", "crosses missing slices"...
  // What was found: the nearest points of a distance, the outline of a threshold region; in the measurement's
  // space.
  std::vector<glm::dvec3> found;
  // Of the object measured upon; empty where it has none.
  std::string sopInstanceUid, frameOfReferenceUid;
  std::int64_t frameNumber = 0;  // in its object, from 1; 0: not on a single frame
  friend bool operator==(const Measured&, const Measured&) = default;
};

// "min -3, max 217, median 41, SD 12" of a region; "" where there are no values. Extrema of stored pixels
// stand as they are, all else to the place of the mean.
VERNIER_API std::string displayStatistics(const Measured&);

// What no +/- includes; stands in every list and file.
inline constexpr const char* kNotIncluded = "not included: scanner geometry, calibration, partial volume";

}  // namespace vernier::measure
