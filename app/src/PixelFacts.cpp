// SPDX-License-Identifier: GPL-3.0-or-later
#include "PixelFacts.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "Sha256.h"
namespace vernier {
namespace {

template <class T>
void widen(const std::vector<std::byte>& bytes, std::vector<double>& out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    T v;
    std::memcpy(&v, bytes.data() + i * sizeof(T), sizeof(T));
    out[i] = static_cast<double>(v);
  }
}
void widen(SampleType type, const std::vector<std::byte>& bytes, std::vector<double>& out) {
  switch (type) {
    case SampleType::U8:
      return widen<std::uint8_t>(bytes, out);
    case SampleType::I8:
      return widen<std::int8_t>(bytes, out);
    case SampleType::U16:
      return widen<std::uint16_t>(bytes, out);
    case SampleType::I16:
      return widen<std::int16_t>(bytes, out);
    case SampleType::U32:
      return widen<std::uint32_t>(bytes, out);
    case SampleType::I32:
      return widen<std::int32_t>(bytes, out);
    case SampleType::F32:
      return widen<float>(bytes, out);
    case SampleType::F64:
      return widen<double>(bytes, out);
  }
}

void addInt32le(const std::vector<double>& values, Sha256& sha) {
  std::vector<unsigned char> bytes(values.size() * 4);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto v = static_cast<std::uint32_t>(static_cast<std::int64_t>(values[i]));
    for (unsigned b = 0; b < 4; ++b) bytes[4 * i + b] = static_cast<unsigned char>(v >> (8 * b));
  }
  sha.add(bytes.data(), bytes.size());
}

}  // namespace

Result<PixelFacts> pixelFacts(const StudySet& set, std::size_t instance,
                              const std::vector<PixelPlace>& probes) {
  const Instance& i = set.instances[instance];
  if (!i.isImage) return makeError(ErrorCode::PixelDataMissing, "The object has no pixel data.");
  if (i.pixelError) return *i.pixelError;
  if (i.pixels.samplesPerPixel != 1)
    return makeError(ErrorCode::PixelDescriptionInvalid,
                     "Facts are given for images of one sample per pixel.");
  const auto bytes = i.pixels.frameBytes();
  if (!bytes) return bytes.error();
  const bool integers = i.pixels.sample != SampleType::F32 && i.pixels.sample != SampleType::F64;

  PixelFacts facts;
  constexpr double kInf = std::numeric_limits<double>::infinity();
  facts.storedMin = kInf;
  facts.storedMax = -kInf;
  double validMin = kInf, validMax = -kInf;
  Sha256 sha;
  std::vector<std::byte> frame(*bytes);
  std::vector<double> values(i.pixels.rows * i.pixels.columns);
  for (std::uint64_t f = 0; f < i.pixels.framesDeclared; ++f) {
    if (const auto done = decodeSlice(set, {instance, f}, frame); !done) return done.error();
    widen(i.pixels.sample, frame, values);
    if (integers) addInt32le(values, sha);
    for (const double v : values) {
      facts.storedMin = std::min(facts.storedMin, v);
      facts.storedMax = std::max(facts.storedMax, v);
      facts.storedSum += v;
      if (v != v) continue;
      if (i.paddingFirst && v >= *i.paddingFirst && v <= *i.paddingLast) {
        ++facts.paddingPixels;
        continue;
      }
      validMin = std::min(validMin, v);
      validMax = std::max(validMax, v);
    }
    if (f == 0)
      for (const PixelPlace& p : probes) facts.probes.push_back(values[p.row * i.pixels.columns + p.column]);
  }
  if (integers) facts.sha256Int32le = sha.hex();
  if (validMin <= validMax) {
    facts.validMin = validMin;
    facts.validMax = validMax;
  }
  return facts;
}

}  // namespace vernier
