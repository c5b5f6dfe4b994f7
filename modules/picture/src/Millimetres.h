// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers for people: at most so many significant digits, never 1e+02.
#pragma once
#include <charconv>
#include <cmath>
#include <string>

namespace vernier {

inline std::string fixedDigits(double x, int decimals) {
  char text[400];
  return {text, std::to_chars(text, text + sizeof text, x, std::chars_format::fixed, decimals).ptr};
}

// So many significant digits without needless zeros: 0.31, 12.5, 400.
inline std::string plainNumber(double x, int digits) {
  if (!std::isfinite(x)) return x != x ? "nan" : x > 0 ? "inf" : "-inf";
  if (x == 0) return "0";
  const int lead = static_cast<int>(std::floor(std::log10(std::abs(x))));
  if (lead < -6 || lead > 15) {
    char text[64];
    return {text, std::to_chars(text, text + sizeof text, x, std::chars_format::general, digits).ptr};
  }
  std::string s = fixedDigits(x, std::max(0, digits - 1 - lead));
  if (s.find('.') != std::string::npos) {
    while (s.back() == '0') s.pop_back();
    if (s.back() == '.') s.pop_back();
  }
  return s;
}

inline std::string millimetres(double mm) { return plainNumber(mm, 4) + " mm"; }

}  // namespace vernier
