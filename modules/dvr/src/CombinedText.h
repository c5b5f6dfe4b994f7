// SPDX-License-Identifier: GPL-3.0-or-later
// What a combiner adds to the shader of a stack (combined.frag.glsl): its function, and the statements that
// fill its registers. Pure.
#pragma once
#include <string>

#include "Combiner.h"

namespace vernier::dvr {

// Slices that one polygon shows: 1 where the combiner interpolates between two textures itself.
std::size_t slicesPerPolygon(const Combiner&);
bool needsNormals(const Combiner&);
bool needsColours(const Combiner&);
// Defines and functions; the samplers lower0, upper0 ... are declared too.
std::string combinedDefines(const Combiner&);

}  // namespace vernier::dvr
