// SPDX-License-Identifier: GPL-3.0-or-later
// One frame of an indexed source into memory: the step that decode(), decodeSlice() and decodeStack() share.
#pragma once
#include "decode/Codecs.h"
#include "decode/PixelIndex.h"

namespace vernier::study {

// Whether a FrameSpec can be acted on at all: it may have come from anywhere. Error: PixelDescriptionInvalid.
Result<void> checkSpec(const FrameSpec& spec);

// Frame number `frame` (from 0) of the object. out.size() == spec.frameBytes(). Zeros on failure.
Result<void> decodeFrame(Source& source, const PixelIndex& index, const FrameSpec& spec, std::uint64_t frame,
                         std::span<std::byte> out, Scratch& scratch);

}  // namespace vernier::study
