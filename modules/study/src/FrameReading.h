// SPDX-License-Identifier: GPL-3.0-or-later
// Attributes that stand in the root of classic objects and in functional group macros of others: read alike.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "AttributeReader.h"
#include "Record.h"

namespace vernier {

// Position and orientation as they stand in a file; NaN where a value is no number.
using Position = std::optional<std::array<double, 3>>;
using Orientation = std::optional<std::array<double, 6>>;
Position positionOf(const std::vector<double>& values);
Orientation orientationOf(const std::vector<double>& values);
// Fills plane, filePlane and rawPlane; all absent when a part is missing or cannot be used.
void setPlane(const Position&, const Orientation&, FrameAttributes&, FrameKeys&);

// Pixel Spacing (0028,0030); false when it is there but cannot be used.
bool readSpacing(const AttributeReader&, FrameAttributes&);

// Rescale Slope, Intercept and Type.
void readRescale(const AttributeReader&, FrameAttributes&, FrameKeys&);
void setRescale(double slope, double intercept, FrameAttributes&);  // refuses 0 and what is not finite

// Windows as they stand there, and the valid ones of them.
struct WindowList {
  std::vector<double> centers, widths, badCenters, badWidths;
  std::vector<VoiWindow> valid;
};
WindowList readWindows(AttributeReader&);

// Modality or VOI LUT (PS3.3 C.11.1, C.11.2): one item of its sequence.
std::optional<LutTable> readLut(AttributeReader& item, bool signedInput);

// The Real World Value Mapping Sequence (0040,9096) of a data set or item; null when there is none that can
// be used.
std::shared_ptr<const std::vector<RealWorldMapping>> readRealWorld(const AttributeReader&, bool signedPixels);

// Kernel, kVp, echo, b-value and the rest that classic objects and unassigned converted attributes hold
// directly.
void readClassicKeys(AttributeReader&, FrameAttributes&, FrameKeys&);

// The unit of modality values; `lutType`: of a modality LUT, where there is one.
std::string unitOf(const Instance&, const FrameAttributes&, const FrameKeys&,
                   const std::optional<std::string>& lutType);

// Codes of the standard are 16 characters long, texts 64; more is cut, so that what a shared group holds can
// stand in each of very many frames.
std::string shortCode(const AttributeReader&, Tag);
std::string shortText(AttributeReader&, Tag);

}  // namespace vernier
