// SPDX-License-Identifier: GPL-3.0-or-later
// Native (not compressed) pixels: DICOM PS3.5 section 8.1 and annex D, PS3.3 C.7.6.3.1.2 (4:2:2).
#include <algorithm>
#include <cstring>

#include "decode/Codecs.h"
#include "decode/Samples.h"

namespace vernier::study {
namespace {

// Single bits fill each byte from its lowest bit.
void unpackBits(ByteSpan native, std::uint64_t firstBit, std::span<std::byte> out) {
  for (std::uint64_t i = 0; i < out.size(); ++i) {
    const std::uint64_t bit = firstBit + i;
    out[i] = (native[bit / 8] >> (bit % 8)) & std::byte{1};
  }
}

// Y1 Y2 Cb Cr for each pair of pixels of a row; both get the pair's chroma.
void spreadChroma(ByteSpan native, std::span<std::byte> out) {
  const std::size_t pairs = out.size() / 6;
  for (std::size_t i = 0; i < pairs; ++i) {
    const std::byte* p = &native[i * 4];
    std::byte* q = &out[i * 6];
    q[0] = p[0];
    q[3] = p[1];
    q[1] = q[4] = p[2];
    q[2] = q[5] = p[3];
  }
}

}  // namespace

Result<void> unpackNative(ByteSpan native, std::uint64_t firstBit, const FrameSpec& spec,
                          std::span<std::byte> out) {
  const auto tooShort = [] {
    return makeError(ErrorCode::PixelDataShort,
                     "The pixel data of a frame is shorter than its rows and columns need.");
  };
  if (spec.bitsAllocated == 1) {
    if (native.size() * 8 < firstBit + out.size()) return tooShort();
    unpackBits(native, firstBit, out);
    return {};
  }
  const Result<std::uint64_t> wanted = spec.nativeFrameBytes();
  if (!wanted) return wanted.error();
  if (native.size() < *wanted) return tooShort();
  if (spec.samplesPerPixel == 3 && spec.photometric.ends_with("_422")) {
    if (spec.bitsAllocated != 8 || spec.columns % 2 != 0 || spec.planar)
      return makeError(ErrorCode::PixelDescriptionInvalid,
                       "4:2:2 pixels must have 8 bits and an even number of columns, and not be planar.");
    spreadChroma(native, out);
    return {};
  }
  if (spec.planar && spec.samplesPerPixel > 1)
    interleave(native.first(*wanted), spec.samplesPerPixel, bytesOf(spec.sample), out);
  else if (native.data() != out.data())
    std::memcpy(out.data(), native.data(), *wanted);
  maskSamples(spec, spec.highBit + 1 - spec.bitsStored, spec.bitsStored, out);
  return {};
}

}  // namespace vernier::study
