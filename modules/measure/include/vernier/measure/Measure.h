// SPDX-License-Identifier: GPL-3.0-or-later
// From a measurement and the data it was drawn upon to numbers. Rules: docs/measurements.md.
//
// +/- is expanded uncertainty, k = 2, by first-order propagation (JCGM 100:2008 5.1): u^2 = sum over points
// of g C g, C = (half a screen pixel)^2 in the picture's plane + spacing^2 / 12 for rows, columns and slices
// along their own directions. Values are sampled in double from stored voxels; images are never warped or
// resized to be measured.
//
// OptionInvalid with one sentence where there is no answer: an arm of no length, a region without a
// pixel, a value from a projection. Pure; safe on any thread when the sources are.
#pragma once
#include <functional>
#include <memory>
#include <stop_token>

#include "vernier/measure/Measured.h"
#include "vernier/measure/Measurement.h"
#include "vernier/volume/ImageCalibration.h"
#include "vernier/volume/ImageFrame.h"
#include "vernier/volume/Volume.h"

namespace vernier::measure {

// A stored frame with what its object says of the size of its pixels.
struct Image {
  std::shared_ptr<const ImageFrame> frame;
  PixelCalibration calibration;
  std::string frameOfReferenceUid;  // "" where there is none
};

// Where the data come from, by the names of Placement and SurfaceRef.
struct Sources {
  std::function<Result<std::shared_ptr<const Volume>>(const std::string& source)> volume;
  std::function<Result<Image>(const std::string& source, std::int64_t frame)> image;
  std::function<Result<std::shared_ptr<const Mesh>>(const std::string& name)> surface;
  // The iso-surface of a source in the patient's frame.
  std::function<Result<std::shared_ptr<const Mesh>>(const std::string& source, double level_val)> isoSurface;
};

VERNIER_API Result<Measured> measure(const Measurement&, const Sources&, std::stop_token = {});

}  // namespace vernier::measure
