// SPDX-License-Identifier: GPL-3.0-or-later
// Hand-made DICOM bytes, for headers that no well-behaved writer would produce.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace vernier::test {

class Bytes {
 public:
  Bytes& raw(const std::string& s) {
    data += s;
    return *this;
  }
  Bytes& u16(std::uint16_t v) {
    data += static_cast<char>(v & 0xff);
    data += static_cast<char>(v >> 8);
    return *this;
  }
  Bytes& u32(std::uint32_t v) {
    return u16(static_cast<std::uint16_t>(v & 0xffff)).u16(static_cast<std::uint16_t>(v >> 16));
  }
  Bytes& tag(std::uint16_t group, std::uint16_t element) { return u16(group).u16(element); }
  // Explicit little endian, short form; the value is padded to even length.
  Bytes& element(std::uint16_t g, std::uint16_t e, const char* vr, std::string value) {
    if (value.size() % 2) value += ' ';
    return tag(g, e).raw(vr).u16(static_cast<std::uint16_t>(value.size())).raw(value);
  }
  // Explicit long form, length as given.
  Bytes& longHead(std::uint16_t g, std::uint16_t e, const char* vr, std::uint32_t length) {
    return tag(g, e).raw(vr).u16(0).u32(length);
  }
  Bytes& item(std::uint32_t length) { return tag(0xFFFE, 0xE000).u32(length); }
  Bytes& itemEnd() { return tag(0xFFFE, 0xE00D).u32(0); }
  Bytes& sequenceEnd() { return tag(0xFFFE, 0xE0DD).u32(0); }
  // Preamble, mark and transfer syntax.
  Bytes& part10(const std::string& syntax = "1.2.840.10008.1.2.1") {
    return raw(std::string(128, '\0')).raw("DICM").element(2, 0x10, "UI", syntax);
  }
  Bytes& ctObject() {
    return element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2")
        .element(8, 0x18, "UI", "1.2.3.4")
        .element(8, 0x60, "CS", "CT");
  }
  std::span<const std::byte> span() const { return std::as_bytes(std::span(data.data(), data.size())); }
  std::string data;
};
inline constexpr std::uint32_t kUndefinedLength = 0xFFFFFFFF;

}  // namespace vernier::test
