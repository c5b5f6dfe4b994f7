// SPDX-License-Identifier: GPL-3.0-or-later
// Where a surface meets a plane: the outline that a slice shows of a tool. In double; pure, safe on any
// thread.
//
// A vertex exactly on the plane counts as lying before it, so that each edge is cut once, at a point that its
// neighbours share bit by bit: the segments of a closed surface join to closed lines.
#pragma once
#include <vector>

#include "vernier/volume/Mesh.h"

namespace vernier {

struct CutSegment {
  PatientPoint a, b;
};

// `normal` need not be a unit vector, but not zero.
VERNIER_API std::vector<CutSegment> cutMesh(const Mesh&, const PatientFromMesh& pose, PatientPoint onPlane,
                                            PatientVec normal);

}  // namespace vernier
