// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <glad/gl.h>

#include "vernier/gpu/Draw.h"

namespace vernier::gpu {

// Rows packed tightly, no pixel buffers.
void statePixelStore(const GladGLContext&);
// States everything that GL 3.3 lets change a fragment between the vertex shader and the target.
void applyState(const GladGLContext&, const DrawState&, unsigned framebuffer, int width, int height);

}  // namespace vernier::gpu
