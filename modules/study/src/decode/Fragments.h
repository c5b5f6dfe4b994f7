// SPDX-License-Identifier: GPL-3.0-or-later
// Which fragments of encapsulated pixel data make up which frame (DICOM PS3.5 A.4). Offset tables are often
// wrong, so they come after what the fragments say: one fragment for each frame; all fragments for a single
// frame; the Basic Offset Table when each of its entries points at a fragment; fragments that begin a new
// compressed image.
#pragma once
#include "decode/PixelIndex.h"

namespace vernier::study {

// Fills index.firstFragment from index.fragments. Error: CodecFailed.
Result<void> assignFragments(Source& source, Extent offsetTable, const FrameSpec& spec, PixelIndex& index);

}  // namespace vernier::study
