// SPDX-License-Identifier: GPL-3.0-or-later
// What all image codecs share: the comparison of their header with the FrameSpec, and the way into the
// container.
#include <cstring>

#include "decode/Codecs.h"
#include "decode/Samples.h"

namespace vernier::study {
namespace {

template <class From, class To>
void widen(ByteSpan from, std::span<std::byte> to) {
  const std::size_t n = to.size() / sizeof(To);
  for (std::size_t i = 0; i < n; ++i) {
    From v;
    std::memcpy(&v, from.data() + i * sizeof v, sizeof v);
    const To w = v;
    std::memcpy(to.data() + i * sizeof w, &w, sizeof w);
  }
}

}  // namespace

Result<void> checkCoded(const CodedImage& coded, const FrameSpec& spec) {
  const auto text = [](std::uint64_t r, std::uint64_t c, std::uint64_t s) {
    return std::to_string(c) + " x " + std::to_string(r) + " with " + std::to_string(s) +
           " sample(s) per pixel";
  };
  if (coded.rows != spec.rows || coded.columns != spec.columns || coded.components != spec.samplesPerPixel)
    return makeError(ErrorCode::CodecMismatch, "The compressed image is " +
                                                   text(coded.rows, coded.columns, coded.components) +
                                                   ", but the attributes say " +
                                                   text(spec.rows, spec.columns, spec.samplesPerPixel) + ".");
  if (spec.isFloat() || coded.precision == 0 || coded.precision > spec.bitsAllocated)
    return makeError(ErrorCode::CodecMismatch, "The compressed image has " + std::to_string(coded.precision) +
                                                   " bits per sample, but the attributes allocate " +
                                                   std::to_string(spec.bitsAllocated) + ".");
  return {};
}

void widenSamples(const FrameSpec& spec, std::uint32_t precision, ByteSpan decoded,
                  std::uint64_t decodedBytes, std::span<std::byte> out) {
  const std::uint64_t bytes = bytesOf(spec.sample);
  if (bytes == decodedBytes) std::memcpy(out.data(), decoded.data(), out.size());
  if (decodedBytes == 1 && bytes == 2) widen<std::uint8_t, std::uint16_t>(decoded, out);
  if (decodedBytes == 1 && bytes == 4) widen<std::uint8_t, std::uint32_t>(decoded, out);
  if (decodedBytes == 2 && bytes == 4) widen<std::uint16_t, std::uint32_t>(decoded, out);
  // A codec of more bits than are stored was fed whole words, with the value at High Bit; else the value is
  // at the bottom, wherever High Bit says that it was before compression (PS3.5 8.2).
  const std::uint32_t lowBit = precision > spec.bitsStored ? spec.highBit + 1 - spec.bitsStored : 0;
  maskSamples(spec, lowBit, spec.bitsStored, out);
}

}  // namespace vernier::study
