// SPDX-License-Identifier: GPL-3.0-or-later
#include "decode/Samples.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

namespace vernier::study {
namespace {

static_assert(std::endian::native == std::endian::little,
              "decode() writes little endian samples as native ones");

template <class T>
T load(const std::byte* p) {
  T v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <class T>
void store(std::byte* p, T v) {
  std::memcpy(p, &v, sizeof v);
}

std::uint16_t reversed(std::uint16_t v) { return __builtin_bswap16(v); }
std::uint32_t reversed(std::uint32_t v) { return __builtin_bswap32(v); }
std::uint64_t reversed(std::uint64_t v) { return __builtin_bswap64(v); }

template <class T>
void swapAll(std::span<std::byte> data) {
  const std::size_t n = data.size() / sizeof(T);
  for (std::size_t i = 0; i < n; ++i)
    store<T>(&data[0] + i * sizeof(T), reversed(load<T>(&data[0] + i * sizeof(T))));
}

template <class T>
void interleaveAll(const std::byte* planes, std::size_t pixels, std::size_t samples, std::byte* out) {
  for (std::size_t s = 0; s < samples; ++s)
    for (std::size_t i = 0; i < pixels; ++i)
      store<T>(out + (i * samples + s) * sizeof(T), load<T>(planes + (s * pixels + i) * sizeof(T)));
}

// T: unsigned container. Signed values: the sign bit is moved up to the container's top and back down.
template <class T>
struct Mask {
  T lowBit, mask, sign;
  bool isSigned;
  T operator()(T v) const {
    v = static_cast<T>((v >> lowBit) & mask);
    return isSigned ? static_cast<T>((v ^ sign) - sign) : v;
  }
};

template <class T>
void maskAll(Mask<T> m, std::byte* p, std::size_t n) {
  T differs = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const T v = load<T>(p + i * sizeof(T));
    differs = static_cast<T>(differs | (v ^ m(v)));
  }
  if (differs == 0) return;
  for (std::size_t i = 0; i < n; ++i) store<T>(p + i * sizeof(T), m(load<T>(p + i * sizeof(T))));
}

template <class T>
void maskTyped(const FrameSpec& spec, std::uint32_t lowBit, std::uint32_t bits, std::span<std::byte> out) {
  constexpr std::uint32_t width = sizeof(T) * 8;
  if (bits >= width || bits == 0 || lowBit >= width) return;
  const T sign = static_cast<T>(T{1} << (bits - 1));
  const T mask = static_cast<T>((sign - 1) | sign);
  maskAll<T>({static_cast<T>(lowBit), mask, sign, spec.isSigned}, out.data(), out.size() / sizeof(T));
}

template <class T>
bool topBitsClear(std::span<const std::byte> samples) {
  const std::byte* p = samples.data();
  const std::size_t n = samples.size() / sizeof(T);
  T any = 0;
  for (std::size_t i = 0; i < n; ++i) any = static_cast<T>(any | load<T>(p + i * sizeof(T)));
  return any >> (sizeof(T) * 8 - 1) == 0;
}

// true when every value survives the way there and back with its sign.
template <class From, class To>
bool convertAll(const std::byte* from, std::byte* to, std::size_t n) {
  bool exact = true;
  for (std::size_t i = 0; i < n; ++i) {
    const From v = load<From>(from + i * sizeof(From));
    if constexpr (std::is_floating_point_v<From> && !std::is_floating_point_v<To>) {
      exact = false;  // a float pixel is never rounded to fit
      (void)v;
    } else if constexpr (std::is_integral_v<From> && std::is_integral_v<To>) {
      exact &= std::in_range<To>(v);
      store<To>(to + i * sizeof(To), static_cast<To>(v));
    } else {
      const To w = static_cast<To>(v);
      // Compared in double: every 32-bit integer and every float is one of its values. NaN stays NaN.
      exact &= static_cast<double>(w) == static_cast<double>(v) || (v != v && w != w);
      store<To>(to + i * sizeof(To), w);
    }
  }
  return exact;
}

template <class From>
bool convertTo(SampleType toType, const std::byte* from, std::byte* to, std::size_t n) {
  switch (toType) {
    case SampleType::U8:
      return convertAll<From, std::uint8_t>(from, to, n);
    case SampleType::I8:
      return convertAll<From, std::int8_t>(from, to, n);
    case SampleType::U16:
      return convertAll<From, std::uint16_t>(from, to, n);
    case SampleType::I16:
      return convertAll<From, std::int16_t>(from, to, n);
    case SampleType::U32:
      return convertAll<From, std::uint32_t>(from, to, n);
    case SampleType::I32:
      return convertAll<From, std::int32_t>(from, to, n);
    case SampleType::F32:
      return convertAll<From, float>(from, to, n);
    case SampleType::F64:
      return convertAll<From, double>(from, to, n);
  }
  return false;
}

bool convertAny(SampleType fromType, SampleType toType, const std::byte* from, std::byte* to, std::size_t n) {
  switch (fromType) {
    case SampleType::U8:
      return convertTo<std::uint8_t>(toType, from, to, n);
    case SampleType::I8:
      return convertTo<std::int8_t>(toType, from, to, n);
    case SampleType::U16:
      return convertTo<std::uint16_t>(toType, from, to, n);
    case SampleType::I16:
      return convertTo<std::int16_t>(toType, from, to, n);
    case SampleType::U32:
      return convertTo<std::uint32_t>(toType, from, to, n);
    case SampleType::I32:
      return convertTo<std::int32_t>(toType, from, to, n);
    case SampleType::F32:
      return convertTo<float>(toType, from, to, n);
    case SampleType::F64:
      return convertTo<double>(toType, from, to, n);
  }
  return false;
}

}  // namespace

bool sameSizeIntegers(SampleType a, SampleType b) {
  const auto isFloat = [](SampleType t) { return t == SampleType::F32 || t == SampleType::F64; };
  return !isFloat(a) && !isFloat(b) && bytesOf(a) == bytesOf(b);
}

bool fitsSameSize(SampleType from, SampleType to, std::span<const std::byte> samples) {
  VERNIER_ASSERT(sameSizeIntegers(from, to));
  if (from == to) return true;
  // One is signed and the other is not: numbers below the top bit are written alike in both.
  switch (bytesOf(from)) {
    case 1:
      return topBitsClear<std::uint8_t>(samples);
    case 2:
      return topBitsClear<std::uint16_t>(samples);
    default:
      return topBitsClear<std::uint32_t>(samples);
  }
}

void swapBytes(std::span<std::byte> data, std::uint64_t bytes) {
  if (data.empty()) return;
  if (bytes == 2) swapAll<std::uint16_t>(data);
  if (bytes == 4) swapAll<std::uint32_t>(data);
  if (bytes == 8) swapAll<std::uint64_t>(data);
}

void interleave(std::span<const std::byte> planes, std::uint64_t samplesPerPixel, std::uint64_t bytes,
                std::span<std::byte> out) {
  const std::size_t pixels = out.size() / (samplesPerPixel * bytes);
  if (bytes == 1) interleaveAll<std::uint8_t>(planes.data(), pixels, samplesPerPixel, out.data());
  if (bytes == 2) interleaveAll<std::uint16_t>(planes.data(), pixels, samplesPerPixel, out.data());
  if (bytes == 4) interleaveAll<std::uint32_t>(planes.data(), pixels, samplesPerPixel, out.data());
  if (bytes == 8) interleaveAll<std::uint64_t>(planes.data(), pixels, samplesPerPixel, out.data());
}

void maskSamples(const FrameSpec& spec, std::uint32_t lowBit, std::uint32_t bits, std::span<std::byte> out) {
  if (spec.isFloat()) return;
  switch (bytesOf(spec.sample)) {
    case 1:
      maskTyped<std::uint8_t>(spec, lowBit, bits, out);
      break;
    case 2:
      maskTyped<std::uint16_t>(spec, lowBit, bits, out);
      break;
    case 4:
      maskTyped<std::uint32_t>(spec, lowBit, bits, out);
      break;
    default:
      break;
  }
}

Result<void> convertSamples(SampleType fromType, std::span<const std::byte> from, SampleType toType,
                            std::span<std::byte> to) {
  const std::size_t n = from.size() / bytesOf(fromType);
  VERNIER_ASSERT(to.size() == n * bytesOf(toType));
  if (!convertAny(fromType, toType, from.data(), to.data(), n))
    return makeError(ErrorCode::CodecMismatch,
                     "The image has values that do not fit the container of its stack; show it on its own.");
  return {};
}

}  // namespace vernier::study
