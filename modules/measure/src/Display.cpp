// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
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

std::string sixDigits(double x) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, x, std::chars_format::general, 6).ptr};
}

// One digit, rounded up: 0.42 -> 5 of 10^-1, 0.96 -> 1 of 10^0. What is a whole digit but for rounding stays.
struct Rounded {
  double digit;
  int exponent;
};
std::optional<Rounded> roundedUp(const std::optional<double>& expanded) {
  if (!expanded || !(*expanded > 0) || !std::isfinite(*expanded)) return std::nullopt;
  Rounded r{0, static_cast<int>(std::floor(std::log10(*expanded)))};
  r.digit = std::ceil(*expanded / std::pow(10.0, r.exponent) * (1 - 1e-12));
  if (r.digit >= 10) r = {1, r.exponent + 1};
  return r;
}

}  // namespace

const char* nameOf(Origin o) { return kOrigins[static_cast<std::size_t>(o)]; }

std::string displayText(const Quantity& q) {
  if (!std::isfinite(q.value)) return "no value";
  const auto r = roundedUp(q.expanded);
  if (!r) return sixDigits(q.value) + unitText(q.unit);
  return atPlace(q.value, r->exponent) + " \u00b1 " +
         atPlace(r->digit * std::pow(10.0, r->exponent), r->exponent) + unitText(q.unit);
}

std::string displayLike(double value, const Quantity& q) {
  const auto r = roundedUp(q.expanded);
  if (!std::isfinite(value)) return "no value";
  return r ? atPlace(value, r->exponent) : sixDigits(value);
}

std::string displayStatistics(const Measured& m) {
  if (!m.values) return "";
  const auto mean = std::find_if(m.quantities.begin(), m.quantities.end(),
                                 [](const Quantity& q) { return q.name == "mean"; });
  const Quantity none, &like = mean == m.quantities.end() ? none : *mean;
  const bool interpolated = std::find(m.notes.begin(), m.notes.end(), "interpolated") != m.notes.end();
  const auto extreme = [&](double x) { return interpolated ? displayLike(x, like) : sixDigits(x); };
  const Statistics& s = *m.values;
  return "min " + extreme(s.min) + ", max " + extreme(s.max) + ", median " + displayLike(s.median, like) +
         (s.sd ? ", SD " + displayLike(*s.sd, like) : "");
}

}  // namespace vernier::measure
