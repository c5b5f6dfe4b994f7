// SPDX-License-Identifier: GPL-3.0-or-later
// Where one image lies on another: a turn and a shift, found by phase correlation (Kuglin and Hines 1975; the
// cross-power spectrum, damped where it holds no signal) and refined to parts of a pixel by the enhanced
// correlation coefficient (Evangelidis and Psarakis 2008, IEEE PAMI 30(10)), which does not mind another
// brightness or contrast. Meant for images of one scene that are turned by a few degrees at most.
//
// Pairs of which no answer could be trusted are refused (OptionInvalid, with a sentence): flat images,
// periodic ones (they lie on each other in many places), opposite contrast, images that do not show the same,
// different size, smaller than 32 x 32, no-data (NaN) inside. Pure, safe on any thread.
#pragma once
#include <cstdint>
#include <vector>

#include "vernier/measure/ImageMetrics.h"

namespace vernier::measure {

inline constexpr int kLeastAlignable_px = 32;

// The pixel of `moving` that shows what pixel (x, y) of `fixed` shows: turned by `rotation_deg` (from the x
// axis towards the y axis, which points down) about the middle of the image, then shifted.
struct Alignment {
  double dx_px = 0, dy_px = 0, rotation_deg = 0;
  double correlation = 0;  // of the two images where they overlap, -1..1
  double residualRms = 0;  // what is left there, in samples' units; moving is sampled linearly, in double
  double overlap = 0;      // share of `fixed` that `moving` covers, 0..1
};

VERNIER_API Result<Alignment> alignRigid(const ImageView& fixed, const ImageView& moving);

// Pixel centres at whole numbers here.
struct ImagePoint {
  double x = 0, y = 0;
};
VERNIER_API ImagePoint movingFromFixed(const Alignment&, const ImageView& fixed, ImagePoint);

// `moving` as it lies on `fixed`, for the eye alone: OpenCV's warp rounds places to 1/32 pixel, so values and
// statistics are never read from it (NUMERICS H5). Outside `moving` it is 0.
VERNIER_API Result<std::vector<std::uint8_t>> warpedForDisplay(const ImageView& moving8bit, const Alignment&);

}  // namespace vernier::measure
