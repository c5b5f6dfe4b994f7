// SPDX-License-Identifier: GPL-3.0-or-later
// Value-of-interest transformation exactly as DICOM PS3.3 C.11.2.1.2 (LINEAR), C.11.2.1.3.1 (SIGMOID) and
// C.11.2.1.3.2 (LINEAR_EXACT), output scaled to 0..1. VoiWindow itself stands in study/Model.h.
#pragma once
#include "vernier/base/Api.h"
#include "vernier/study/Model.h"

namespace vernier {

// Grey 0..1 of a modality value; NaN stays NaN. Width <= 0 or not finite: the caller has replaced it
// (usableWindow).
VERNIER_API double applyVoi(const VoiWindow&, double modality);

// LINEAR and LINEAR_EXACT are clamp((x - lo) / (hi - lo)) with x <= lo -> 0 and x > hi -> 1; lo == hi is a
// step.
struct VoiRamp {
  double lo = 0, hi = 1;
};
VERNIER_API VoiRamp rampOf(const VoiWindow&);  // for Linear and LinearExact only

// false for width <= 0 or NaN/Inf. A LINEAR width below 1 is taken as LINEAR_EXACT by normalised().
VERNIER_API bool usableWindow(const VoiWindow&);
VERNIER_API VoiWindow normalised(VoiWindow);

// Output of a modality or VOI LUT (PS3.3 C.11.1.1, C.11.2.1.1): values before the first mapped one take the
// first entry, values past the last take the last. An empty table gives 0.
VERNIER_API double lookUp(const LutTable&, double value);
// A VOI LUT scaled to 0..1 by its bits per entry.
VERNIER_API double applyVoi(const LutTable&, double modality);

}  // namespace vernier
