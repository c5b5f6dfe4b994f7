// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier::measure {
namespace {

constexpr std::size_t kMostBins = 256, kMostLags = 64;
constexpr std::size_t kMostCorrelated = 1'000'000;  // of more values, lines spread evenly are looked at

// A sum that carries what each addition rounds away (A. Neumaier, 1974).
class Sum {
 public:
  void add(double x) {
    const double t = sum_ + x;
    carried_ += std::abs(sum_) >= std::abs(x) ? (sum_ - t) + x : (x - t) + sum_;
    sum_ = t;
  }
  double value() const { return sum_ + carried_; }

 private:
  double sum_ = 0, carried_ = 0;
};

double medianOf(std::vector<double>& v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  if (v.size() % 2 == 1) return *middle;
  const double below = *std::max_element(v.begin(), middle);
  return below + (*middle - below) / 2;
}

Histogram histogramOf(const std::vector<double>& v, double min, double max, double step) {
  Histogram h;
  h.first = min;
  const double range = max - min;
  if (range <= 0) {
    h.width = step > 0 ? step : 1;
    h.counts = {v.size()};
    return h;
  }
  h.width = range / static_cast<double>(kMostBins);
  if (step > 0) {  // whole steps, so that every bin holds as many possible values as the next
    const double steps = std::round(range / step) + 1;
    h.width = step * std::max(1.0, std::ceil(steps / static_cast<double>(kMostBins)));
    h.first = min - step / 2;
  }
  const auto bins = static_cast<std::size_t>(std::clamp(
      std::ceil((range + (step > 0 ? step : 0)) / h.width - 1e-9), 1.0, static_cast<double>(kMostBins)));
  h.counts.assign(bins, 0);
  for (const double x : v)
    ++h.counts[std::min(bins - 1, static_cast<std::size_t>(std::max(0.0, (x - h.first) / h.width)))];
  return h;
}

// 1 + 2 sum of the autocorrelation at lags along one direction, up to its first zero.
double correlationLength(const Raster& r, double mean, bool alongRows) {
  const std::size_t rows = r.values.size() / r.columns;
  const std::size_t extent = alongRows ? r.columns : rows;
  const std::size_t skip = 1 + r.values.size() / kMostCorrelated;
  double length = 1, variance = 0;
  std::uint64_t n = 0;
  for (const double x : r.values)
    if (!std::isnan(x)) variance += (x - mean) * (x - mean), ++n;
  if (n < 2 || !(variance > 0)) return 1;
  variance /= static_cast<double>(n);
  for (std::size_t lag = 1; lag < std::min(extent, kMostLags + 1); ++lag) {
    double sum = 0;
    std::uint64_t pairs = 0;
    const std::size_t lastRow = alongRows ? rows : rows - lag,
                      lastColumn = alongRows ? r.columns - lag : r.columns;
    const std::size_t away = alongRows ? lag : lag * r.columns;
    for (std::size_t j = 0; j < lastRow; j += alongRows ? skip : 1)
      for (std::size_t i = 0; i < lastColumn; i += alongRows ? 1 : skip) {
        const double a = r.values[j * r.columns + i], b = r.values[j * r.columns + i + away];
        if (std::isnan(a) || std::isnan(b)) continue;
        sum += (a - mean) * (b - mean);
        ++pairs;
      }
    const double rho = pairs > 0 ? sum / static_cast<double>(pairs) / variance : 0;
    if (!(rho > 0)) break;
    length += 2 * std::min(1.0, rho);
  }
  return length;
}

}  // namespace

Statistics statisticsOf(std::vector<double> values, double step) {
  Statistics s;
  std::erase_if(values, [](double x) { return std::isnan(x); });
  s.n = values.size();
  s.effective = static_cast<double>(s.n);
  if (values.empty()) return s;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  s.min = *low;
  s.max = *high;
  // The sums run over differences from the first value: what is common to all costs no digits.
  const double first = values.front(), n = static_cast<double>(s.n);
  Sum sum;
  for (const double x : values) sum.add(x - first);
  const double shift = sum.value() / n;
  s.mean = first + shift;
  if (s.n > 1) {
    Sum squares;
    for (const double x : values) {
      const double d = (x - first) - shift;
      squares.add(d * d);
    }
    s.sd = std::sqrt(squares.value() / (n - 1));
  }
  s.histogram = histogramOf(values, s.min, s.max, step);
  s.median = medianOf(values);
  return s;
}

double effectiveCount(const Raster& raster, double mean, std::uint64_t n) {
  if (n < 2 || raster.columns == 0) return static_cast<double>(n);
  const double lengths = correlationLength(raster, mean, true) * correlationLength(raster, mean, false);
  return std::clamp(static_cast<double>(n) / lengths, 1.0, static_cast<double>(n));
}

}  // namespace vernier::measure
