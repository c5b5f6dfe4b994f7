// SPDX-License-Identifier: GPL-3.0-or-later
// Text of any Specific Character Set (0008,0005) to UTF-8: PS3.5 6.1 and PS3.3 C.12.1.1.2. ISO 2022 escapes
// are split here, run by run; iconv converts each run.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vernier {

struct DecodedText {
  std::string utf8;
  bool damaged = false;  // bytes that could not be decoded stand as U+FFFD
};

// `charset`: the values of (0008,0005); empty = ASCII. Person names keep their three component groups ("="
// between them; empty groups at the end are dropped).
DecodedText decodeText(std::string_view bytes, const std::vector<std::string>& charset,
                       bool personName = false);

std::vector<std::string> splitValues(std::string_view text, char by = '\\');

// Decimal and integer strings (DS, IS) as PS3.5 6.2 defines them; a value that is none is nullopt.
std::optional<double> parseDecimal(std::string_view);
std::optional<std::int64_t> parseInteger(std::string_view);

}  // namespace vernier
