// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as text, the same on every machine and in every locale.
#pragma once
#include <charconv>
#include <string>

namespace vernier::measure {

// The shortest text that reads back as the same double.
inline std::string shortest(double x) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, x).ptr};
}
inline std::string fixed(double x, int decimals) {
  char text[512];
  return {text, std::to_chars(text, text + sizeof text, x, std::chars_format::fixed, decimals).ptr};
}

}  // namespace vernier::measure
