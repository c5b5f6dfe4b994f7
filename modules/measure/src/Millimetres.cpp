// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Millimetres.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "Numbers.h"

namespace vernier::measure {
namespace {

constexpr std::uint16_t kCentimetres = 3;  // PS3.3 C.8.5.5.1.15

// Pairs of DICOM are row\column: the distance between rows comes first.
PixelScale inMillimetres(glm::dvec2 rowColumn, Origin origin, std::string text) {
  return {{rowColumn.y, rowColumn.x}, "mm", origin, std::move(text)};
}
bool usable(glm::dvec2 s) { return s.x > 0 && s.y > 0 && std::isfinite(s.x) && std::isfinite(s.y); }

bool isProjection(const ImageFrameInfo& f) {
  constexpr std::array kProjections = {"CR", "DX", "MG", "XA", "RF", "IO", "PX", "RG", "XC"};
  return !f.plane && std::find(kProjections.begin(), kProjections.end(), f.modality) != kProjections.end();
}

// The region that holds all points and says how long a pixel is.
const UltrasoundRegion* regionOf(const PixelCalibration& c, std::span<const Spot> points) {
  for (const UltrasoundRegion& r : c.regions) {
    const bool lengths =
        r.unitsX == kCentimetres && r.unitsY == kCentimetres && r.deltaX != 0 && r.deltaY != 0;
    const auto inside = [&](const Spot& p) {
      return p.x >= static_cast<double>(r.firstColumn) && p.x <= static_cast<double>(r.lastColumn + 1) &&
             p.y >= static_cast<double>(r.firstRow) && p.y <= static_cast<double>(r.lastRow + 1);
    };
    if (lengths && !points.empty() && std::all_of(points.begin(), points.end(), inside)) return &r;
  }
  return nullptr;
}

PixelScale inPixels(const PixelCalibration& c, const char* why) {
  PixelScale s;
  if (c.aspectRatio) {  // vertical\horizontal
    const glm::dvec2 a = *c.aspectRatio;
    s.perPixel = {1, a.x / a.y};
    s.origin = Origin::SquaredPixels;
    s.text = "px of the columns' width (Pixel Aspect Ratio " + shortest(a.x) + "\\" + shortest(a.y) + ")";
  }
  if (*why) s.text += std::string(", ") + why;
  return s;
}

PixelScale projection(const ImageFrameInfo& f, const PixelCalibration& c) {
  if (usable(f.pixelSpacing_mm) && !c.calibrationType.empty() &&
      (!c.imagerSpacing_mm || *c.imagerSpacing_mm != f.pixelSpacing_mm))
    return inMillimetres(f.pixelSpacing_mm, Origin::Calibrated, "mm (calibrated: " + c.calibrationType + ")");
  if (c.imagerSpacing_mm && c.radiographicMagnification && *c.radiographicMagnification != 1)
    return inMillimetres(*c.imagerSpacing_mm / *c.radiographicMagnification, Origin::Magnified,
                         "mm, magnification " + shortest(*c.radiographicMagnification));
  if (c.imagerSpacing_mm) return inMillimetres(*c.imagerSpacing_mm, Origin::AtDetector, "mm at detector");
  if (c.filmSpacing_mm) return inMillimetres(*c.filmSpacing_mm, Origin::Film, "mm on film");
  return inPixels(c, "the projection is not calibrated");
}

}  // namespace

FileScale fileScaleOf(std::span<const Finding> findings) {
  FileScale s;
  for (const Finding& f : findings) {
    if (f.code == "length-unit-assumed") s.text = "mm (assumed: the file states no unit of length)";
    if (f.code == "spacing-assumed") return {Origin::Pixels, "px, the file states no spacing"};
  }
  return s;
}

PixelScale pixelScaleOf(const ImageFrameInfo& f, const PixelCalibration& c, std::span<const Spot> points,
                        const std::optional<glm::dvec2>& userSpacing_mm) {
  if (userSpacing_mm && usable(*userSpacing_mm))
    return inMillimetres(*userSpacing_mm, Origin::User, "mm (user)");
  if (!c.regions.empty()) {
    if (const UltrasoundRegion* r = regionOf(c, points))
      return inMillimetres({10 * std::abs(r->deltaY), 10 * std::abs(r->deltaX)}, Origin::UltrasoundRegion,
                           "mm (ultrasound region)");
    return inPixels(c, "not within one calibrated ultrasound region");
  }
  if (isProjection(f)) return projection(f, c);
  if (c.secondaryCapture) {
    if (usable(f.pixelSpacing_mm) && !c.calibrationType.empty())
      return inMillimetres(f.pixelSpacing_mm, Origin::Calibrated,
                           "mm (calibrated: " + c.calibrationType + ")");
    if (c.filmSpacing_mm) return inMillimetres(*c.filmSpacing_mm, Origin::Film, "mm on film");
    return inPixels(c, "a secondary capture without calibration");
  }
  const bool ultrasound = f.modality == "US" || f.modality == "IVUS";
  if (usable(f.pixelSpacing_mm) && (!ultrasound || f.plane)) {
    if (!f.sopInstanceUid.empty())
      return inMillimetres(f.pixelSpacing_mm, Origin::PixelSpacing, "mm (Pixel Spacing)");
    const FileScale file = fileScaleOf(f.findings);
    PixelScale s = inMillimetres(f.pixelSpacing_mm, file.origin, file.text);
    if (file.origin == Origin::Pixels) s.unit = "px";
    return s;
  }
  if (c.filmSpacing_mm) return inMillimetres(*c.filmSpacing_mm, Origin::Film, "mm on film");
  return inPixels(c, "");
}

}  // namespace vernier::measure
