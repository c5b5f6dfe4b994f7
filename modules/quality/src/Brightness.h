// SPDX-License-Identifier: GPL-3.0-or-later
// What a window and a depth cue make of the field along one piece of a ray: the brightest point, the mean
// grey, the places where the field passes a value.
#pragma once
#include <vector>

#include "Field.h"
#include "vernier/volume/Voi.h"

namespace vernier::quality {

// The factor of a depth cue along a piece: numerator / denominator, both at most of first degree, never
// negative and never rising with u.
struct Cue {
  Poly numerator{{1}, 0}, denominator{{1}, 0};
  double operator()(double u) const { return numerator(u) / denominator(u); }
};

// The greatest product of grey and cue on the piece, or `atLeast` where none is greater. Windows of straight
// lines: exact but for rounding, from the ends, the window's knots and the roots of the derivative (a
// polynomial of at most seventh degree). Sigmoid: bracketed to 1e-9 of itself.
double brightest(const Piece&, const VoiWindow&, const Cue&, double atLeast);

// The mean of the grey over the piece. Cut at the window's knots; between them exact (plain pieces and
// windows of straight lines) or Gauss-Legendre to 1e-12.
double meanGrey(const Piece&, const VoiWindow&);

// Where the field is neither rising nor falling, ascending, with the piece's ends before and after. Next to
// no-data the ends are a hair inside, where the field still has a value.
std::vector<double> monotoneStops(const Piece&);

// The place between `from` and `to` where the field, which is monotone there, gets to be at least `level`, or
// ceases to be.
double crossing(const Piece&, double level, double from, double to);

}  // namespace vernier::quality
