// SPDX-License-Identifier: GPL-3.0-or-later
// The figure that every picture carries: its measured error against the double reference (Reference.h), in
// levels of 255 of the displayed range, with its confidence.
//
// Compared is the frame in float, before it is quantised to 8 bits and before letters are drawn; the largest
// of R, G and B counts; both sides are clamped to 0..1, as the display does, and a NaN counts as 255 levels.
// Population: pixels whose ray can contribute (the outline of each layer, dilated by 2 pixels); its share of
// the picture is stated. Samples are stratified, seeded and without replacement; up to 4 n pixels are all
// tested. The bound says: `share` of the population lies within it, with probability `confidence` over the
// seeds (OrderStatistic.h).
//
// Edge pixels (within 1 pixel of the border of the data: the slice's outline, padding, a gap; of tools and
// cuts; of lenses, as far as they change what is seen; of iso-surfaces and of steps of a transfer function,
// where a surface ends or lies much farther off than its slope explains) are also reported apart, but never
// left out of the bound. Thread-safe; parallelFor inside. Errors: those of referencePixels, and SceneInvalid
// when frame and view differ in size.
#pragma once
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>

#include "vernier/plan/Frame.h"
#include "vernier/quality/Reference.h"

namespace vernier::quality {

struct ErrorOptions {
  std::size_t samples = 1024;
  std::uint64_t seed = 1;
  double share = 0.99, confidence = 0.99;
  ReferenceOptions reference;
};

// Only when the frame kept its values before the window (View::wantValues) and the topmost layer is a slice.
struct ValueError {
  std::size_t n = 0;                      // pixels with a value on both sides
  double max_val = 0;                     // largest |engine - double|, modality units
  std::size_t coverageDiffers = 0;        // pixels where one side has data and the other has not
  std::size_t coverageDiffersInside = 0;  // of these, not edge pixels
  double worstOfBound =
      0;  // largest |engine - double| / (1e-4 local range + 1e-6 stored range + float rounding)
};

struct ErrorReport {
  std::size_t n = 0, population = 0;
  double populationShare = 0;  // of all pixels of the picture
  double max = 0, rms = 0, p50 = 0, p99 = 0;
  double innerP95 = 0;          // of the pixels that are no edges: 95 % of them lie within it
  std::optional<double> bound;  // absent: too few samples to bound anything at this confidence
  std::size_t rank = 0;         // the bound is the rank-th largest difference
  double share = 0.99, confidence = 0.99;
  bool exhaustive = false;  // every pixel of the population was tested: the bound is certain
  struct Edge {
    double share = 0;  // of the sample
    double p99 = 0, max = 0;
  } edge;
  double quantisation = 0.5;  // what 8 bits add, stated apart
  ErrorKind kind = ErrorKind::Model;
  std::uint64_t seed = 1;
  std::optional<ValueError> values;
};

VERNIER_API Result<ErrorReport> measureError(const Frame&, const Scene&, const View&, const Sources&,
                                             const ErrorOptions& = {}, std::stop_token = {});

// "99 % within 0.31 levels of 255 (99 % sure), max 0.4, n 1024"
VERNIER_API std::string errorSentence(const ErrorReport&);
VERNIER_API const char* nameOf(ErrorKind);  // "model", "implementation"

}  // namespace vernier::quality
