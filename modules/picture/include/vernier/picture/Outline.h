// SPDX-License-Identifier: GPL-3.0-or-later
// Lines on a picture: the outlines of surfaces on slices. Drawn on 8-bit pixels, after the error was taken
// and before the letters, smooth at their edges. A pixel is blended once, however many segments pass it.
// Pure; safe on any thread.
#pragma once
#include <span>

#include "vernier/picture/Picture.h"
#include "vernier/plan/PictureGeometry.h"

namespace vernier {

struct LineSegment {
  glm::dvec2 a, b;  // pixels, centres at half-integers
};

// opacity 0..1. A dark seam one pixel wide sets the line off from bright bone. What is not finite is left
// out.
VERNIER_API void drawLines(Picture&, std::span<const LineSegment>, Rgb colour, double width_px,
                           double opacity = 1);

// Where the planes of slice and surface meet, in pixels of the picture.
VERNIER_API std::vector<LineSegment> outlineOf(const SurfaceLayer&, const Mesh&, const SliceLayer&,
                                               const SlicePicture&);

}  // namespace vernier
