// SPDX-License-Identifier: GPL-3.0-or-later
// What stands on a picture beside the image: letters, scale bar, lines of text. Drawn on 8-bit pixels, after
// the error was taken. `Annotations` says what, `Layout` where: both are plain data, so that the window can
// draw the same.
//
// The drawings of a presentation state come first, under everything else.
// Places: letters at the middle of each edge; `what` at the top left; FLIPPED at the top right; `status` at
// the bottom left; the scale bar at the bottom right. Nothing overlaps: what has no room is left out, the
// least important first (letters, FLIPPED, what, status, scale bar; within a list the last first), and listed
// in Layout::dropped. A number is never cut: a line that is too long is replaced by its short form or left
// out. Text is light with a dark outline, so that it can be read on any background. scale 1..3 (100 to 300 %)
// enlarges all sizes. Pure functions, safe on any thread.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/picture/Graphics.h"
#include "vernier/picture/Picture.h"
#include "vernier/plan/PictureGeometry.h"

namespace vernier {

enum class Tone { Normal, Amber };  // amber: above the user's limit, or mirrored

struct TextLine {
  std::string text;       // UTF-8
  std::string shortText;  // where the picture is too narrow for text; may be empty
  Tone tone = Tone::Normal;
  friend bool operator==(const TextLine&, const TextLine&) = default;
};

struct Annotations {
  EdgeLetters letters;
  bool flipped = false;
  std::vector<TextLine> what;    // what the picture is, most important first
  std::vector<TextLine> status;  // error, window...
  double mmPerPixel = 0;         // 0: not known, the scale bar's place says that lengths are in px
  bool scaleBar = true;
  Graphics graphics;  // of a presentation state
};

struct Box {
  int x = 0, y = 0, width = 0, height = 0;
};
struct LaidText {
  std::string text;
  int x = 0, baseline = 0, size_px = 0;
  Tone tone = Tone::Normal;
  Box box;  // with its outline; the soft shadow goes a little further
};
struct LaidBar {
  int x0 = 0, x1 = 0, y = 0, thickness = 1, tick = 3;  // a line from x0 to x1 with ticks up at its ends
  double length_mm = 0;
  Box box;
};
struct Layout {
  std::vector<LaidText> texts;
  std::optional<LaidBar> bar;
  std::vector<std::string> dropped;
  Graphics graphics;  // under all letters
  int letter_px = 12;
};

VERNIER_API Layout layoutAnnotations(const Annotations&, int width, int height, double scale = 1);
VERNIER_API void drawLayout(Picture&, const Layout&);
VERNIER_API void annotate(Picture&, const Annotations&, double scale = 1);

// The longest of 1, 2, 5 x 10^k mm that is at most `most_px` long.
VERNIER_API double scaleBarLength_mm(double mmPerPixel, double most_px);

}  // namespace vernier
