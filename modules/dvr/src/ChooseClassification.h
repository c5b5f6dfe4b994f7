// SPDX-License-Identifier: GPL-3.0-or-later
// Post- or pre-integrated classification where the layer leaves it open: pre-integrated where the transfer
// function is steeper than a step.
//
// At places spread over the volume (the same ones every time) the field's gradient tells how far the value
// goes within one step. There the opacity that the middle of the step has (post) is held against the mean
// opacity over that way. Of the places where either is above 0 the root of the mean square of the difference
// is taken: above kSteep the function is steeper than the step. So a soft function is looked up after
// interpolation, which keeps the second order, and a narrow peak or a hard threshold is integrated. Smaller
// steps make any function gentle but for its jumps.
#pragma once
#include "vernier/plan/Scene.h"
#include "vernier/volume/Volume.h"

namespace vernier::dvr {

inline constexpr double kSteep = 0.05;

// The root mean square, 0..1. Grey volumes; pure, a millisecond or two, and nothing when it is asked again on
// the same thread.
double steepness(const Volume&, const TransferFunction&, double step_mm);

inline Classification chooseClassification(const Volume& v, const TransferFunction& f, double step_mm) {
  return steepness(v, f, step_mm) > kSteep ? Classification::PreIntegrated : Classification::Post;
}

}  // namespace vernier::dvr
