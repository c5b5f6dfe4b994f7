// SPDX-License-Identifier: GPL-3.0-or-later
// The layer kind "example.band": colours the pixels of the slice below it whose values lie in a band, for
// example the bone of a CT between 300 and 3000 HU. Keys of the layer (all but `kind` may be absent):
// `source` (the volume whose values count; absent: the slice's own), `low`, `high` (modality values, both
// inside the band), `opacity` 0..1, `outline` (only the band's border is drawn, one pixel wide).
#pragma once
#include "vernier/plan/Panel.h"
#include "vernier/plan/Technique.h"

namespace example {

// What a user may set; the window draws these controls.
vernier::Panel bandPanel();
// How the layer is drawn: on the processor, in double, one row of pixels after the other on all cores.
vernier::Technique bandTechnique();

}  // namespace example
