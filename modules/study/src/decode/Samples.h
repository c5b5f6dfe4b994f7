// SPDX-License-Identifier: GPL-3.0-or-later
// What is done to samples after they were taken out of their coding: byte order, interleaving, mask and sign,
// another container. Plain loops that the compiler vectorises. Source: DICOM PS3.5 section 8.1.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "vernier/base/Result.h"
#include "vernier/study/FrameSpec.h"

namespace vernier::study {

// Reverses the bytes of each sample of `bytes` (1, 2, 4, 8); a rest that is no whole sample stays.
void swapBytes(std::span<std::byte> data, std::uint64_t bytes);

// `planes`: all samples 0, then all samples 1... -> interleaved by pixel.
void interleave(std::span<const std::byte> planes, std::uint64_t samplesPerPixel, std::uint64_t bytes,
                std::span<std::byte> out);

// In place: value = bits [lowBit, lowBit + bits) of each sample of the container spec.sample, sign-extended
// when spec.isSigned. Does not write to samples that are in order already. Floats stay as they are.
void maskSamples(const FrameSpec& spec, std::uint32_t lowBit, std::uint32_t bits, std::span<std::byte> out);

// Whether every sample means the same number in `to` as in `from`: two integer containers of the same size.
bool fitsSameSize(SampleType from, SampleType to, std::span<const std::byte> samples);
bool sameSizeIntegers(SampleType a, SampleType b);

// Copies n samples into another container; CodecMismatch when a value does not fit exactly. `from` and `to`
// may be the same memory when the containers have the same size.
Result<void> convertSamples(SampleType fromType, std::span<const std::byte> from, SampleType toType,
                            std::span<std::byte> to);

}  // namespace vernier::study
