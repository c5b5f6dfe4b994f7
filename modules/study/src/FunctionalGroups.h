// SPDX-License-Identifier: GPL-3.0-or-later
// Functional groups of multi-frame objects (PS3.3 C.7.6.16): what holds for each frame is its per-frame
// group's, else the shared group's, never the root's.
#pragma once
#include "AttributeReader.h"
#include "Record.h"

namespace vernier {

bool hasFunctionalGroups(const Header&);

// Fills Instance::frames, the base attributes (those of the first frame), frameKeys, dimensions,
// frameWindows, convertedFrom and findings. Where the number of per-frame groups is not the number of frames,
// which group belongs to which frame is unknown: only what is shared is used, and the frames have no places.
// Needs framesDeclared, modality and the pixels' sign.
void readFunctionalGroups(AttributeReader& root, Record& record);

}  // namespace vernier
