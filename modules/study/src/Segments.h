// SPDX-License-Identifier: GPL-3.0-or-later
// Segmentations: which segments there are and how they wish to be shown (PS3.3 C.8.20.2).
#pragma once
#include <array>
#include <cstdint>

#include "AttributeReader.h"
#include "Record.h"

namespace vernier {

void readSegments(AttributeReader& root, Record& record);

// Recommended Display CIELab Value (PS3.3 C.10.7.1.1: L* 0..100 and a*, b* -128..127 over 0..65535, D50) to
// sRGB (IEC 61966-2-1, D65 by Bradford's adaptation), 0..1; colours outside of sRGB are clamped.
std::array<double, 3> srgbFromCieLab(const std::array<std::uint16_t, 3>& lab);

}  // namespace vernier
