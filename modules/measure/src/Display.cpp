// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "Numbers.h"
#include "vernier/measure/Measured.h"

namespace vernier::measure {
namespace {

constexpr const char* kOrigins[] = {"pixels",        "squared_pixels",
                                    "pixel_spacing", "ultrasound_region",
                                    "calibrated",    "at_detector",
                                    "magnified",     "film",
                                    "user",          "file"};

std::string unitText(const std::string& unit) {
  if (unit == "1" || unit.empty()) return "";
  if (unit == "deg") return "\u00b0";
  if (unit.ends_with("2") || unit.ends_with("3"))
    return " " + unit.substr(0, unit.size() - 1) + (unit.back() == '2' ? "\u00b2" : "\u00b3");
  return " " + unit;
}

std::string withoutSign(std::string s) {  // "-0.0" says nothing that "0.0" does not
  return s.find_first_not_of("-0.") == std::string::npos && s.starts_with("-") ? s.substr(1) : s;
}

// x at the place 10^exponent.
std::string atPlace(double x, int exponent) {
  if (exponent >= 0) {
    const double unit = std::pow(10.0, exponent);
    return withoutSign(fixed(std::round(x / unit) * unit, 0));
  }
  return withoutSign(fixed(x, -exponent));
}

}  // namespace

const char* nameOf(Origin o) { return kOrigins[static_cast<std::size_t>(o)]; }

std::string displayText(const Quantity& q) {
  if (!std::isfinite(q.value)) return "no value";
  if (!q.expanded || !(*q.expanded > 0) || !std::isfinite(*q.expanded)) {
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text, q.value, std::chars_format::general, 6).ptr;
    return std::string(text, end) + unitText(q.unit);
  }
  // One digit, rounded up: 0.42 -> 0.5, 0.96 -> 1. What is a whole digit but for rounding stays.
  int exponent = static_cast<int>(std::floor(std::log10(*q.expanded)));
  double digit = std::ceil(*q.expanded / std::pow(10.0, exponent) * (1 - 1e-12));
  if (digit >= 10) digit = 1, ++exponent;
  return atPlace(q.value, exponent) + " \u00b1 " + atPlace(digit * std::pow(10.0, exponent), exponent) +
         unitText(q.unit);
}

}  // namespace vernier::measure
