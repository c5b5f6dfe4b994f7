// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of all rays, one image of them after the other: between translucent tools, and where lenses cut
// them (Ropinski 2005, section 3). How one image of parts is drawn is the technique's: rays, stacks or slabs.
#pragma once
#include <functional>

#include "GlDrawing.h"

namespace vernier::dvr {

using DrawPart = std::function<Result<DrawnPart>(const RayImages&)>;

// Into the picture what the pass draws of it. `planar` as in RayParts. Internal where the rays were cut for a
// picture of another size.
Result<void> drawParts(const GlVolumeJob&, bool planar, const RaysOfPass&, Images&, std::stop_token,
                       const DrawPart&);

// Extremes with lenses are not for volumes: NoTechnique with the sentence.
Result<void> checkParts(const GlVolumeJob&, const PlanContext&);

}  // namespace vernier::dvr
