// SPDX-License-Identifier: GPL-3.0-or-later
// Single elements of a DICOM byte stream: tag, VR and length (PS3.5 7.1), and the way past a sequence of
// undefined length (PS3.5 7.5), without recursion and without trusting any length.
#pragma once
#include <cstdint>
#include <optional>

#include "Header.h"

namespace vernier::elements {

constexpr Tag kItem = 0xFFFEE000, kItemEnd = 0xFFFEE00D, kSequenceEnd = 0xFFFEE0DD;
constexpr std::uint32_t kUndefined = 0xFFFFFFFF;

bool knownVr(char a, char b);
std::uint16_t u16(const std::byte*, bool bigEndian);

// Tag, VR and length of one element; the value begins at `value`.
struct Head {
  Tag tag = 0;
  char vr[2] = {' ', ' '};
  std::uint32_t length = 0;
  std::uint64_t value = 0;
};

// nullopt: the source ends inside the head.
std::optional<Head> readHead(ByteSource&, std::uint64_t at, Encoding);

// What the content of a sequence is encoded in: UN of undefined length is implicit little endian
// (PS3.5 6.2.2).
Encoding contentEncoding(const Head&, Encoding);

struct Skipped {
  std::uint64_t contentEnd = 0;  // where the closing delimiter stands
  std::uint64_t next = 0;        // behind it
};

// From the first item of a sequence of undefined length to behind its delimiter.
Result<Skipped> skipSequence(ByteSource&, std::uint64_t at, const Head& sequence, Encoding outer);

Error damaged(std::string sentence);
Error cutShort(Tag);

}  // namespace vernier::elements
