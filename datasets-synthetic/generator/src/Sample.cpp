// SPDX-License-Identifier: GPL-3.0-or-later
#include "Sample.h"

#include <algorithm>
#include <cmath>

#include "vernier/base/Random.h"

namespace vernier::phantoms {
namespace {

// About normal, unit variance: four 16-bit uniforms of one hash, added as integers (variance of one: (2^32 -
// 1) / 12).
float unitNoise(std::uint64_t seed, std::uint64_t counter) {
  const std::uint64_t bits = randomBits(seed, counter);
  const auto sum = static_cast<std::int64_t>((bits & 0xFFFF) + ((bits >> 16) & 0xFFFF) +
                                             ((bits >> 32) & 0xFFFF) + (bits >> 48));
  return static_cast<float>(static_cast<double>(sum - 2 * 0xFFFF) * (1.0 / 37837.227));
}

// White noise through the kernel (1 1; 1 1) / 2: unit variance, a little grain as reconstructed slices have.
class Grain {
 public:
  Grain(std::uint64_t seed, std::int64_t key, std::int64_t columns)
      : seed_(randomBits(seed, static_cast<std::uint64_t>(key))),
        upper_(static_cast<std::size_t>(columns) + 1),
        lower_(upper_.size()) {
    fill(lower_, 0);
  }
  void nextRow(std::int64_t row) {
    std::swap(upper_, lower_);
    fill(lower_, row + 1);
  }
  double at(std::size_t i) const { return 0.5 * (upper_[i] + upper_[i + 1] + lower_[i] + lower_[i + 1]); }

 private:
  void fill(std::vector<float>& line, std::int64_t row) {
    for (std::size_t i = 0; i < line.size(); ++i)
      line[i] = unitNoise(seed_, (static_cast<std::uint64_t>(row) << 32) | i);
  }
  std::uint64_t seed_;
  std::vector<float> upper_, lower_;
};

AxisBox boxOfSlice(const SeriesPlan& series, const SlicePlan& slice) {
  const glm::dvec3 u = static_cast<double>(series.columns - 1) * series.columnSpacing_mm * slice.rowDirection;
  const glm::dvec3 v = static_cast<double>(series.rows - 1) * series.rowSpacing_mm * slice.columnDirection;
  const glm::dvec3 a = slice.origin_mm, b = a + u, c = a + v, d = b + v;
  return {glm::min(glm::min(a, b), glm::min(c, d)), glm::max(glm::max(a, b), glm::max(c, d))};
}

}  // namespace

StoredRange storedRange(const SeriesPlan& s) {
  if (s.isSigned) return {-(1 << (s.bitsStored - 1)), (1 << (s.bitsStored - 1)) - 1};
  return {0, (1 << s.bitsStored) - 1};
}

std::vector<std::int32_t> sampleSlice(const Field& whole, const SeriesPlan& series, const SlicePlan& slice,
                                      std::uint64_t seed) {
  const std::unique_ptr<const Field> part = whole.within(boxOfSlice(series, slice));
  const Field& field = part ? *part : whole;
  const auto columns = static_cast<std::size_t>(series.columns);
  std::vector<std::int32_t> stored(columns * static_cast<std::size_t>(series.rows));
  std::vector<double> value(columns), noise(columns);
  const StoredRange range = storedRange(series);
  const double slope = slopeOf(series, slice);
  const double middleColumn = 0.5 * static_cast<double>(series.columns - 1);
  const double middleRow = 0.5 * static_cast<double>(series.rows - 1);
  Grain grain(seed, slice.noiseKey, series.columns);
  for (std::int64_t j = 0; j < series.rows; ++j) {
    RowLine line;
    line.start_mm = slice.origin_mm + static_cast<double>(j) * series.rowSpacing_mm * slice.columnDirection;
    line.step_mm = series.columnSpacing_mm * slice.rowDirection;
    line.count = series.columns;
    field.row(line, value, noise);
    grain.nextRow(j);
    std::int32_t* out = stored.data() + static_cast<std::size_t>(j) * columns;
    for (std::size_t i = 0; i < columns; ++i) {
      double modality = slice.factor * value[i] + slice.valueOffset;
      if (noise[i] > 0.0) modality += noise[i] * grain.at(i);
      const double v = std::floor((modality - series.intercept) / slope + 0.5);
      out[i] = static_cast<std::int32_t>(std::clamp<double>(v, range.low, range.high));
      if (series.padding) {
        const double dx = (static_cast<double>(i) - middleColumn) * series.columnSpacing_mm;
        const double dy = (static_cast<double>(j) - middleRow) * series.rowSpacing_mm;
        if (dx * dx + dy * dy > series.fieldOfView_mm * series.fieldOfView_mm) out[i] = *series.padding;
      }
    }
  }
  return stored;
}

double slopeOf(const SeriesPlan& series, const SlicePlan& slice) {
  return slice.slope != 0 ? slice.slope : series.slope;
}

std::vector<std::int32_t> sampleChannels(const std::vector<const Field*>& fields, std::size_t channels,
                                         const SeriesPlan& series, const SlicePlan& slice,
                                         std::uint64_t seed) {
  if (channels == 1) return sampleSlice(*fields.front(), series, slice, seed);
  std::vector<std::int32_t> out;
  for (std::size_t c = 0; c < channels; ++c) {
    const std::vector<std::int32_t> one = sampleSlice(*fields[c], series, slice, seed);
    out.resize(one.size() * channels);
    for (std::size_t n = 0; n < one.size(); ++n) out[n * channels + c] = one[n];
  }
  return out;
}

double idealAt(const Field& field, glm::dvec3 p_mm) {
  double value = 0, noise = 0;
  field.row(RowLine{p_mm, {1, 0, 0}, 1}, {&value, 1}, {&noise, 1});
  return value;
}

}  // namespace vernier::phantoms
