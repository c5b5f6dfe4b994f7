// SPDX-License-Identifier: GPL-3.0-or-later
// What a hand does to the points of a measurement: which of them it can take, and what follows the one that
// it moves. Pure; what is at right angles is so on the picture, whose pixels are square in mm.
#pragma once
#include "Measuring.h"

namespace vernier::ui {

inline constexpr std::size_t kMostGrips = 10;  // of an outline drawn by hand

// Of handlesOf(shape), those that are drawn and can be taken: all, of an outline drawn by hand some, evenly
// spread.
std::vector<std::size_t> gripsOf(const measure::Shape&);

// Moves handle n. Of an outline drawn by hand the points up to the neighbouring grips follow, less with their
// distance. Of diameters the short axis stays at right angles to the long one: with an end of the long axis
// it turns, with one of its own ends it slides along.
void moveGrip(measure::Shape&, std::size_t n, measure::Spot to, const Place&, measure::Space);

// Where the fourth point of diameters stands when the hand is at `px`: at right angles to the long axis,
// through the third.
glm::dvec2 acrossLongAxis(glm::dvec2 a, glm::dvec2 b, glm::dvec2 third, glm::dvec2 px);

// When the hand lets go: of diameters the longer one is the long axis.
void settleGrips(measure::Shape&, const Place&, measure::Space);

}  // namespace vernier::ui
