// SPDX-License-Identifier: GPL-3.0-or-later
// Two pictures of one size as one, to see what differs. OptionInvalid for different sizes or channels. Pure
// functions, safe on any thread.
#pragma once
#include "vernier/base/Result.h"
#include "vernier/picture/Picture.h"

namespace vernier {

// Left of `position` (0..1 of the width) a, else b; with a line of one pixel between them.
VERNIER_API Result<Picture> wipe(const Picture& a, const Picture& b, double position = 0.5);
// Squares of `tile_px`; the first, top left, is of a.
VERNIER_API Result<Picture> checkerboard(const Picture& a, const Picture& b, int tile_px = 32);

// Where b is brighter orange, where a is brighter blue, where nothing differs a as dark grey, so that one
// sees where one is. Full colour from kFullColour levels on, the square root below, so that one level is
// seen.
inline constexpr int kFullColour = 64;
VERNIER_API Result<Picture> signedDifference(const Picture& a, const Picture& b);

}  // namespace vernier
