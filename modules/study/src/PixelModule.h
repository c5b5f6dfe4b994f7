// SPDX-License-Identifier: GPL-3.0-or-later
// The Image Pixel attributes of a header, checked by the one function that computes every FrameSpec.
#pragma once
#include "Header.h"
#include "vernier/study/FrameSpec.h"

namespace vernier {
Result<FrameSpec> frameSpecOf(const Header& header);
}  // namespace vernier
