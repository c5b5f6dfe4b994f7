// SPDX-License-Identifier: GPL-3.0-or-later
// A picture drawn with fewer pixels, brought to the size of the screen.
#pragma once
#include "vernier/picture/Picture.h"

namespace vernier::ui {

// RGB, linear between pixel centres; the middles of both pictures coincide. `perPixel`: how many pixels of
// the result are as long as one of the small picture. On all threads.
Picture enlarged(const Picture& small, double perPixel, int width_px, int height_px);

}  // namespace vernier::ui
