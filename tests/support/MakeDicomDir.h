// SPDX-License-Identifier: GPL-3.0-or-later
// A DICOMDIR that names any files, as its bytes (explicit little endian): one IMAGE record per file ID, whose
// components are divided by a backslash.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace vernier::test {

inline std::string dicomDirBytes(const std::vector<std::string>& fileIds) {
  const auto number = [](std::uint64_t x, int bytes) {
    std::string s;
    for (int i = 0; i < bytes; ++i) s += static_cast<char>(x >> 8 * i);
    return s;
  };
  const auto element = [&](std::uint32_t tag, const char* vr, std::string value) {
    if (value.size() % 2) value += vr[0] == 'U' ? '\0' : ' ';
    return number(tag >> 16, 2) + number(tag & 0xffff, 2) + vr + number(value.size(), 2) + value;
  };
  std::string items;
  for (const std::string& id : fileIds) {
    const std::string record = element(0x00041430, "CS", "IMAGE") + element(0x00041500, "CS", id);
    items += number(0xfffe, 2) + number(0xe000, 2) + number(record.size(), 4) + record;
  }
  const std::string meta = element(0x00020002, "UI", "1.2.840.10008.1.3.10") +
                           element(0x00020003, "UI", "2.25.77") +
                           element(0x00020010, "UI", "1.2.840.10008.1.2.1");
  return std::string(128, '\0') + "DICM" + element(0x00020000, "UL", number(meta.size(), 4)) + meta +
         number(4, 2) + number(0x1220, 2) + "SQ" + number(0, 2) + number(items.size(), 4) + items;
}

}  // namespace vernier::test
