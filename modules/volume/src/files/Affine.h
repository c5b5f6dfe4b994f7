// SPDX-License-Identifier: GPL-3.0-or-later
// Rules on geometry that all volume files share.
#pragma once
#include <string>

#include "vernier/base/GridGeometry.h"
#include "vernier/base/Result.h"
#include "vernier/study/Findings.h"

namespace vernier {

// From a map to RAS (x to the patient's right) to the same map to LPS: two rows change their sign.
PatientFromVoxel lpsFromRas(PatientFromVoxel);

// An axis of one voxel may have no length: it then gets the normal of the other two, 1 mm long (a single
// slice has no step). Afterwards all lengths must be finite and lie in 1e-4..1e3 mm and the axes must span a
// volume: GeometryRefused otherwise.
Result<void> settleAxes(GridGeometry&);

// "axes-unknown": the file does not say what its axes mean. Pictures then have no letters.
Finding axesUnknown(const std::string& why);

}  // namespace vernier
