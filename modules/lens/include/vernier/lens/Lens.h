// SPDX-License-Identifier: GPL-3.0-or-later
// The lens techniques: they make convex regions of lens layers, cut the rays of a picture at them and join
// what others have drawn of the parts. registerLens adds to the host:
//   lens.native  intervals in double, joined on the CPU    (kind lens)
// Source: T. Ropinski, F. Steinicke, K. Hinrichs, An Efficient Approach for Emphasizing Regions of Interest
// in Ray-Casting based Volume Rendering, 2005.
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::lens {
Result<void> registerLens(Host&);
}
