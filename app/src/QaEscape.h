// SPDX-License-Identifier: GPL-3.0-or-later
// Text as it may stand in HTML and XML, between tags and inside double quotes. Control characters, which XML
// does not know, become spaces.
#pragma once
#include <string>

namespace vernier::app {

inline std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
    }
  return out;
}

}  // namespace vernier::app
