// SPDX-License-Identifier: GPL-3.0-or-later
// Many pictures with captions on one sheet, in a grid. Pictures larger than a cell are made smaller by
// averaging over the area of each new pixel, smaller ones stay as they are, centred.
#pragma once
#include <string>
#include <vector>

#include "vernier/base/Result.h"
#include "vernier/picture/Picture.h"

namespace vernier {

struct SheetEntry {
  Picture picture;                 // 3 channels
  std::string caption;             // bold part of the text under it: "axial"
  std::vector<std::string> lines;  // "0.4 ms, native", "error <= 0.01 of 255 (99 %)"
};

// LimitExceeded when the sheet would pass the limits of Png.h; OptionInvalid without entries.
VERNIER_API Result<Picture> contactSheet(const std::string& title, const std::vector<SheetEntry>&,
                                         int columns = 3, int cell_px = 400);

// Area average, for each new pixel exactly; never enlarges beyond `width` x `height`, which are >= 1.
VERNIER_API Picture shrunk(const Picture&, int width, int height);

}  // namespace vernier
