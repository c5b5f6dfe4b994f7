// SPDX-License-Identifier: GPL-3.0-or-later
// One function per coding: the bytes of one compressed frame in, samples interleaved by pixel in spec's
// container out. Each compares the codec's own header with the FrameSpec before it writes, and never writes
// outside `out`, whose size is spec.frameBytes(). Errors: CodecFailed, CodecMismatch, LimitExceeded. Sources:
// DICOM PS3.5 section 8.2 and annexes A, F, G; ITU-T T.81, T.87, T.800.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vernier/base/Result.h"
#include "vernier/study/FrameSpec.h"

namespace vernier::study {

using ByteSpan = std::span<const std::byte>;

// Buffers that are kept from frame to frame, one set per thread.
struct Scratch {
  std::vector<std::byte> frame;             // the compressed frame
  std::vector<std::byte> pixels;            // decoded, before interleaving or widening
  ColourSpace colours = ColourSpace::Grey;  // of the frame decoded last
};

// What the codec's header says of the image.
struct CodedImage {
  std::uint64_t rows = 0, columns = 0, components = 0;
  std::uint32_t precision = 0;
};
// Size and components must be equal, the precision at most Bits Allocated (and within the codec's own
// limits).
Result<void> checkCoded(const CodedImage& coded, const FrameSpec& spec);

// Samples of `precision` bits, low-aligned in a container of 1 or 2 bytes -> spec's container, masked and
// signed.
void widenSamples(const FrameSpec& spec, std::uint32_t precision, ByteSpan decoded,
                  std::uint64_t decodedBytes, std::span<std::byte> out);

Result<void> decodeRle(ByteSpan frame, const FrameSpec& spec, std::span<std::byte> out, Scratch& scratch);
Result<void> decodeJpeg(ByteSpan frame, const FrameSpec& spec, std::span<std::byte> out, Scratch& scratch);
Result<void> decodeJpegLs(ByteSpan frame, const FrameSpec& spec, std::span<std::byte> out, Scratch& scratch);
Result<void> decodeJpeg2000(ByteSpan frame, const FrameSpec& spec, std::span<std::byte> out,
                            Scratch& scratch);

// One frame's native bytes (as they stand in the data set, brought to little endian) -> out: unpacks single
// bits, spreads 4:2:2 chroma, interleaves planes, masks and sign-extends. firstBit: for 1-bit pixels, where
// the frame begins in `native`; else 0.
Result<void> unpackNative(ByteSpan native, std::uint64_t firstBit, const FrameSpec& spec,
                          std::span<std::byte> out);

// Raw deflate (RFC 1951) of a whole data set or of one frame. At most limits::kMaxInflateRatio x input and
// limits::kMaxInflatedBytes come out. Errors: FileDamaged, LimitExceeded.
Result<std::vector<std::byte>> inflateAll(ByteSpan deflated);

}  // namespace vernier::study
