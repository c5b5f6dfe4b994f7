// SPDX-License-Identifier: GPL-3.0-or-later
// Multi-frame objects without functional groups, whose vectors say what each frame is: radiotherapy dose
// (PS3.3 C.8.8.3), nuclear medicine (C.8.4.8 to C.8.4.15), cine times of ultrasound, angiography and
// secondary capture (C.7.6.5). The root's attributes hold for all frames.
#pragma once
#include "AttributeReader.h"
#include "Record.h"

namespace vernier {

// Dose values and the place of each plane of the dose grid. Needs the plane of the root and framesDeclared.
void readDose(const AttributeReader& root, Record& record);

// Frames of reconstructed slices get their places; energy windows, detectors, gates tell stacks apart.
void readNuclear(const AttributeReader& root, Record& record);

// Instance::frameTimes_ms.
void readFrameTimes(const AttributeReader& root, Record& record);

}  // namespace vernier
