// SPDX-License-Identifier: GPL-3.0-or-later
// What stands on a finished picture: what its topmost layer says about itself, the measured error, and what
// the plan could not show.
#pragma once
#include "Session.h"
#include "vernier/picture/Describe.h"
#include "vernier/picture/Png.h"

namespace vernier::app {

// `limit`: the error that the user asked for; the figure is amber above it.
Result<Annotations> annotationsFor(Session&, const Scene&, const View&, const Rendered&,
                                   std::optional<double> limit);

// Not one pixel has data: the plane misses the volume, or all there is padding.
bool showsNothing(const Images&);
inline constexpr const char* kNoDataHere = "no data here: move the plane or zoom out";

// What a PNG says of itself beside its pixels: the program, its engine, the measured error. No value of the
// patient.
std::vector<PngText> pngTexts(const Scene&, const Rendered&);

// The 8-bit picture with its letters; `scale` 1..3.
Result<Picture> finishedPicture(Session&, const Scene&, const View&, const Rendered&,
                                std::optional<double> limit, double scale);

}  // namespace vernier::app
