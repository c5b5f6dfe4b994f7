// SPDX-License-Identifier: GPL-3.0-or-later
// Is a picture worth comparing with? A baseline that is blank, or a tolerance that would let a fault pass,
// proves nothing. So a baseline is spoilt on purpose, in ways that real faults take, and the comparison must
// notice each of them. Pure functions, safe on any thread; pictures of 1 pixel and more.
#pragma once
#include <array>
#include <optional>
#include <string_view>

#include "vernier/base/Api.h"
#include "vernier/picture/Picture.h"

namespace vernier {

struct PictureFacts {
  int colours = 0;     // how many different ones there are, counted up to 65536
  double sd = 0;       // of all samples, levels of 255
  double covered = 0;  // share of the pixels that are not of the commonest colour, 0..1
};
VERNIER_API PictureFacts factsOf(const Picture&);

enum class Mutant {
  ShiftedRight,   // by one pixel; the edge is repeated
  ShiftedDown,    // likewise
  Mirrored,       // left and right swapped
  Gamma,          // levels to the power 1/1.1
  Blank,          // all of the commonest colour
  ObjectMissing,  // the smallest thing of at least kLeastObject_px pixels painted over
};
inline constexpr std::array kMutants = {Mutant::ShiftedRight, Mutant::ShiftedDown, Mutant::Mirrored,
                                        Mutant::Gamma,        Mutant::Blank,       Mutant::ObjectMissing};
inline constexpr int kLeastObject_px = 16;

VERNIER_API const char* nameOf(Mutant);  // "shifted-right", as case.json writes it
VERNIER_API std::optional<Mutant> mutantNamed(std::string_view);
VERNIER_API const char* saying(Mutant);  // "shifted right by a pixel", for sentences

// A thing is an area, connected by edges, of pixels that differ from the commonest colour by more than
// kObjectContrast levels in a channel; without one of at least kLeastObject_px pixels the largest goes.
inline constexpr int kObjectContrast = 8;
VERNIER_API Picture mutantOf(const Picture&, Mutant);

}  // namespace vernier
