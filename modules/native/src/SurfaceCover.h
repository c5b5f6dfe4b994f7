// SPDX-License-Identifier: GPL-3.0-or-later
// Which pixels of a tile a triangle covers: three edge functions in double, as many pixels at a time as the
// processor has lanes. Product and sum are rounded one after the other on every instruction set, so that all
// give the same bits.
#pragma once
#include <cstdint>

namespace vernier::native {

// E(x, y) = a x + b y + c is positive on one side of a line. A pixel centre exactly on it counts as
// `zeroIsPositive`.
struct EdgeLine {
  double a, b, c;
  bool zeroIsPositive;
};

// Sets bit n of rows[y - y0] where the centre of pixel (x0 + n, y), x0 + n + 0.5, lies on the same side of
// all three lines. width <= 64; `rows` holds `height` numbers.
void coverRows(const EdgeLine (&edges)[3], int x0, int y0, int width, int height, std::uint64_t* rows);

}  // namespace vernier::native
