// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "vernier/base/GridGeometry.h"
#include "vernier/base/Result.h"

namespace vernier {

// GeometryRefused unless all numbers are finite and the three axes span a volume, so that the map has an
// inverse.
Result<void> checkMap(const PatientFromVoxel&);

}  // namespace vernier
