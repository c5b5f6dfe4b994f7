// SPDX-License-Identifier: GPL-3.0-or-later
// Grey 0..1 of a modality value: DICOM PS3.3 C.11.2.1.2, written down here once more so that the reference
// does not inherit a mistake of the engines.
#pragma once
#include "vernier/volume/Voi.h"

namespace vernier::quality {

double windowGrey(const VoiWindow&, double modality);
double lutGrey(const LutTable&, double modality);

}  // namespace vernier::quality
