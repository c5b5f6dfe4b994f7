// SPDX-License-Identifier: GPL-3.0-or-later
// Gaps (slices that are missing) are hatched on slices, so that nobody takes them for black background or
// air. Drawn on 8-bit pixels, after the error was taken and before the letters. Pure; safe on any thread.
#pragma once
#include "vernier/picture/Picture.h"
#include "vernier/plan/CurvedGeometry.h"

namespace vernier {

// Diagonal lines over the pixels of a slice that show nothing (`images.depth`) and whose centre lies between
// the two slices on either side of a gap. Gives the number of pixels that lie in a gap; without gaps nothing
// is looked at.
VERNIER_API std::size_t hatchGaps(Picture&, const Images&, const SlicePicture&, const GridGeometry&);
VERNIER_API std::size_t hatchGaps(Picture&, const Images&, const CurvedPicture&, const GridGeometry&);

}  // namespace vernier
