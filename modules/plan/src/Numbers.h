// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as text, the same on every machine and in every locale.
#pragma once
#include <charconv>
#include <string>

namespace vernier {

// Rounded to so many significant digits: 0.4, 12.3, 1e-06.
inline std::string rounded(double x, int digits) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::general, digits).ptr;
  return {text, end};
}

// The shortest text that reads back as the same double.
inline std::string shortest(double x) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, x).ptr;
  return {text, end};
}

}  // namespace vernier
