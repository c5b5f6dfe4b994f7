// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers in sentences: at most six digits, the same in every locale.
#pragma once
#include <charconv>
#include <string>

namespace vernier::lens {

inline std::string inWords(double v) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::general, 6);
  return std::string(text, end.ptr);
}

}  // namespace vernier::lens
