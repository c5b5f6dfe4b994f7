// SPDX-License-Identifier: GPL-3.0-or-later
#include "PixelFacts.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "Sha256.h"
#include "vernier/volume/Colour.h"

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

// Extrema of one frame's stored values become part of those of all modality values.
void widen(std::optional<PixelFacts::Range>& all, const ModalityRescale& r, double storedMin,
           double storedMax) {
  if (!(storedMin <= storedMax)) return;
  const double a = r.slope * storedMin + r.intercept, b = r.slope * storedMax + r.intercept;
  if (!all) all = PixelFacts::Range{a, a};
  all->min = std::min({all->min, a, b});
  all->max = std::max({all->max, a, b});
}

bool hasModality(const Instance& i) {
  return !i.modalityLut && !i.rescaleInvalid && i.segmentation == SegmentationKind::None;
}

}  // namespace

Result<ColourFacts> colourFacts(const StudySet& set, std::size_t instance,
                                const std::vector<PixelPlace>& probes) {
  const Instance& i = set.instances[instance];
  if (i.pixelError) return *i.pixelError;
  const auto bytes = i.pixels.frameBytes();
  if (!bytes) return bytes.error();
  std::vector<std::byte> frame(*bytes);
  ColourSpace space = ColourSpace::Grey;
  if (const auto done = decodeSlice(set, {instance, 0}, frame, &space); !done) return done.error();
  const std::size_t samples = i.pixels.samplesPerPixel, pixels = i.pixels.rows * i.pixels.columns;
  std::vector<double> values(pixels * samples);
  widen(i.pixels.sample, frame, values);
  const auto colourAt = [&](std::size_t p) {
    std::array<double, 3> s{};
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(p * samples), samples, s.begin());
    return rgbOf(space, s, i.pixels.bitsStored, i.palette.get());
  };
  ColourFacts facts;
  for (std::size_t p = 0; p < pixels; ++p) {
    const glm::dvec3 rgb = colourAt(p);
    for (int c = 0; c < 3; ++c) facts.rgbMean[static_cast<std::size_t>(c)] += std::floor(255 * rgb[c] + 0.5);
  }
  for (double& m : facts.rgbMean) m /= static_cast<double>(pixels);
  for (const PixelPlace& p : probes) {
    const std::size_t at = p.row * i.pixels.columns + p.column;
    const glm::dvec3 rgb = 255.0 * colourAt(at);
    facts.rgb.push_back({rgb.x, rgb.y, rgb.z});
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(at * samples);
    facts.stored.emplace_back(first, first + static_cast<std::ptrdiff_t>(samples));
  }
  return facts;
}

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
  const bool modality = hasModality(i);
  FrameReader reader(set);
  Sha256 sha;
  std::vector<std::byte> frame(*bytes);
  std::vector<double> values(i.pixels.rows * i.pixels.columns);
  for (std::uint64_t f = 0; f < i.pixels.framesDeclared; ++f) {
    if (const auto done = reader.read({instance, f}, frame); !done) return done.error();
    widen(i.pixels.sample, frame, values);
    if (integers) addInt32le(values, sha);
    const FrameAttributes& a = i.frame(f);
    double low = kInf, high = -kInf, validLow = kInf, validHigh = -kInf;
    for (const double v : values) {
      low = std::min(low, v);
      high = std::max(high, v);
      facts.storedSum += v;
      if (v != v) continue;
      if (a.paddingFirst && v >= *a.paddingFirst && v <= *a.paddingLast) {
        ++facts.paddingPixels;
        continue;
      }
      validLow = std::min(validLow, v);
      validHigh = std::max(validHigh, v);
    }
    facts.storedMin = std::min(facts.storedMin, low);
    facts.storedMax = std::max(facts.storedMax, high);
    if (modality && !a.rescaleInvalid) {
      widen(facts.modality, a.rescale, low, high);
      widen(facts.modalityValid, a.rescale, validLow, validHigh);
    }
    if (f == 0)
      for (const PixelPlace& p : probes) facts.probes.push_back(values[p.row * i.pixels.columns + p.column]);
  }
  if (integers) facts.sha256Int32le = sha.hex();
  return facts;
}

}  // namespace vernier
