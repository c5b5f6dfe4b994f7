// SPDX-License-Identifier: GPL-3.0-or-later
#include "Grey.h"

#include <algorithm>
#include <cmath>

namespace vernier::quality {

double windowGrey(const VoiWindow& w, double x) {
  if (std::isnan(x)) return x;
  if (w.function == VoiFunction::Sigmoid) return 1.0 / (1.0 + std::exp(-4.0 * (x - w.center) / w.width));
  // LINEAR is defined for widths of at least 1 only; below, it is taken as LINEAR_EXACT.
  const bool exact = w.function == VoiFunction::LinearExact || w.width < 1.0;
  const double centre = exact ? w.center : w.center - 0.5;
  const double width = exact ? w.width : w.width - 1.0;
  if (x <= centre - width / 2) return 0;
  if (x > centre + width / 2) return 1;
  return (x - centre) / width + 0.5;
}

double lutGrey(const LutTable& lut, double x) {
  if (std::isnan(x) || lut.data.empty()) return x;
  const double last = static_cast<double>(lut.data.size() - 1);
  const double index = std::clamp(std::floor(x - lut.firstMapped + 0.5), 0.0, last);
  const double top = std::ldexp(1.0, static_cast<int>(lut.bits)) - 1.0;
  return std::clamp(lut.data[static_cast<std::size_t>(index)] / top, 0.0, 1.0);
}

}  // namespace vernier::quality
