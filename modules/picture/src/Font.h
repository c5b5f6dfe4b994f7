// SPDX-License-Identifier: GPL-3.0-or-later
// Text with the embedded font (DejaVu Sans): measured and drawn on a picture. Widths are whole pixels, so
// that a layout is the same everywhere. Characters that the font lacks show its box; control characters are
// left out.
#pragma once
#include <string_view>

#include "vernier/picture/Picture.h"

namespace vernier {

struct TextSize {
  int width = 0, ascent = 0, descent = 0;  // descent positive, below the baseline
};
TextSize measureText(std::string_view utf8, int size_px);

// How far the solid part of the outline reaches beyond the glyphs; a soft shadow goes as far again.
int outlineReach_px(int size_px);

// Both take the left end of the baseline; parts outside the picture are cut. Where several texts stand
// together all outlines are drawn first, so that none darkens its neighbour's text.
void drawOutline(Picture&, int x, int baseline, std::string_view utf8, int size_px);
void drawText(Picture&, int x, int baseline, std::string_view utf8, int size_px, Rgb8 colour);

// A filled box, cut at the picture's borders.
void fillBox(Picture&, int x, int y, int width, int height, Rgb8 colour);

}  // namespace vernier
