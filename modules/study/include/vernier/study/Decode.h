// SPDX-License-Identifier: GPL-3.0-or-later
// Decoding of pixels: bytes of a whole DICOM file in, stored values out.
#pragma once
#include <cstddef>
#include <span>

#include "vernier/study/FrameSpec.h"

namespace vernier {

// Decodes frames [spec.firstFrame, spec.firstFrame + spec.frameCount) into `out`, whose size must equal
// spec.outputBytes(). Output: row by row, samples interleaved, native endian, masked to BitsStored at HighBit
// and sign-extended; photometric as stored (no colour conversion but what the codec itself defines). Errors:
// PixelDataMissing, PixelDataShort, CodecUnsupported, CodecFailed, CodecMismatch, LimitExceeded. `out` holds
// zeros where an error stopped the work. Thread-safe; no globals, no paths. `colours`, when given, takes what
// the samples of the frames are (of the last one, should they differ).
VERNIER_API Result<void> decode(std::span<const std::byte> file, const FrameSpec& spec,
                                std::span<std::byte> out, ColourSpace* colours = nullptr);

}  // namespace vernier
