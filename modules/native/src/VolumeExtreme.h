// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "vernier/native/VolumeRender.h"

namespace vernier::native {
// Modes Max and Min, by the projections of Projection.h.
Result<void> renderExtreme(const VolumeRenderJob&, Images&, std::stop_token);
}  // namespace vernier::native
