// SPDX-License-Identifier: GPL-3.0-or-later
// The drawings of a presentation state (PS3.3 C.10.5): lines, circles, ellipses and texts, in the layer of
// the letters, drawn on 8-bit pixels after the error was taken. Plain data in picture coordinates, so that a
// window can draw the same. Pure functions, safe on any thread.
#pragma once
#include <string>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/picture/Picture.h"
#include "vernier/plan/PictureGeometry.h"

namespace vernier {

struct DrawnLine {
  std::vector<glm::dvec2> points_px;
  bool filled = false;  // the area inside (even-odd) too; the line is then closed
  double grey = 1;
};
struct DrawnText {
  std::string text;         // UTF-8, lines divided by \n
  glm::dvec2 corner_px{0};  // its top left
  bool atAnchor = false;    // the corner is a point that the text stands beside
  double grey = 1;
};
struct Graphics {
  std::vector<DrawnLine> lines;
  std::vector<DrawnText> texts;
  bool empty() const { return lines.empty() && texts.empty(); }
};

// Circles, ellipses and interpolated curves become lines of points at most about a pixel off.
VERNIER_API Graphics graphicsOf(const FramePresentation&, const ImagePicture&, const ImageFrameInfo&);
// Lines about a pixel wide with an edge of the opposite brightness; letters of `letter_px`.
VERNIER_API void drawGraphics(Picture&, const Graphics&, int letter_px);

}  // namespace vernier
