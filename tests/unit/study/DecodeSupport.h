// SPDX-License-Identifier: GPL-3.0-or-later
// Hand-made DICOM files for decoder tests, and the reading of real ones.
#pragma once
#include <openssl/evp.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "vernier/study/Decode.h"

namespace vernier::test {

using Bytes = std::vector<std::byte>;

inline Bytes bytesOfFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string s((std::istreambuf_iterator<char>(in)), {});
  Bytes b(s.size());
  if (!s.empty()) std::memcpy(b.data(), s.data(), s.size());
  return b;
}

// Writes elements one after the other.
class DicomWriter {
 public:
  explicit DicomWriter(bool isExplicit = true, bool big = false, bool preamble = true)
      : explicit_(isExplicit), big_(big) {
    if (!preamble) return;
    out_.assign(128, std::byte{0});
    for (char c : {'D', 'I', 'C', 'M'}) out_.push_back(static_cast<std::byte>(c));
    // One meta element is enough for the decoder: (0002,0010), always explicit little endian.
    for (int v : std::initializer_list<int>{2, 0, 0x10, 0, 'U', 'I', 2, 0, '1', 0})
      out_.push_back(static_cast<std::byte>(v));
  }
  DicomWriter& u16(unsigned v) {
    const std::byte lo{static_cast<unsigned char>(v & 0xFF)}, hi{static_cast<unsigned char>(v >> 8 & 0xFF)};
    out_.push_back(big_ ? hi : lo);
    out_.push_back(big_ ? lo : hi);
    return *this;
  }
  DicomWriter& u32(std::uint32_t v) {
    return big_ ? u16(v >> 16).u16(v & 0xFFFF) : u16(v & 0xFFFF).u16(v >> 16);
  }
  DicomWriter& raw(const Bytes& b) {
    out_.insert(out_.end(), b.begin(), b.end());
    return *this;
  }
  // Header with a length of its own choice; the value follows by raw().
  DicomWriter& header(unsigned group, unsigned element, const char* vr, std::uint32_t length) {
    u16(group).u16(element);
    if (!explicit_ || group == 0xFFFE) return u32(length);
    out_.push_back(static_cast<std::byte>(vr[0]));
    out_.push_back(static_cast<std::byte>(vr[1]));
    const std::string v(vr);
    const bool isLong =
        v == "OB" || v == "OW" || v == "OF" || v == "OD" || v == "SQ" || v == "UN" || v == "UT";
    return isLong ? u16(0).u32(length) : u16(length);
  }
  DicomWriter& element(unsigned group, unsigned elem, const char* vr, const Bytes& value) {
    return header(group, elem, vr, static_cast<std::uint32_t>(value.size())).raw(value);
  }
  DicomWriter& item(const Bytes& value) {
    return header(0xFFFE, 0xE000, "", static_cast<std::uint32_t>(value.size())).raw(value);
  }
  DicomWriter& sequenceEnd() { return header(0xFFFE, 0xE0DD, "", 0); }
  // Something in front, so that the walk has to walk.
  DicomWriter& start() { return element(0x0008, 0x0060, "CS", {std::byte{'C'}, std::byte{'T'}}); }
  DicomWriter& pixels(const Bytes& value, const char* vr = "OW") {
    return element(0x7FE0, 0x0010, vr, value);
  }
  // Encapsulated pixel data with an empty offset table.
  DicomWriter& fragments(const std::vector<Bytes>& all) {
    header(0x7FE0, 0x0010, "OB", 0xFFFFFFFF).item({});
    for (const Bytes& b : all) item(b);
    return sequenceEnd();
  }
  const Bytes& bytes() const { return out_; }

 private:
  Bytes out_;
  bool explicit_, big_;
};

inline Bytes bytesFrom(std::initializer_list<int> values) {
  Bytes b;
  for (int v : values) b.push_back(static_cast<std::byte>(v));
  return b;
}

inline constexpr const char* kImplicit = "1.2.840.10008.1.2";
inline constexpr const char* kExplicit = "1.2.840.10008.1.2.1";
inline constexpr const char* kBig = "1.2.840.10008.1.2.2";
inline constexpr const char* kDeflated = "1.2.840.10008.1.2.1.99";
inline constexpr const char* kRle = "1.2.840.10008.1.2.5";

inline FrameSpec makeSpec(const char* syntax, std::uint64_t rows, std::uint64_t columns, unsigned allocated,
                          unsigned stored, bool isSigned = false, std::uint64_t samples = 1) {
  FrameSpec s;
  s.transferSyntaxUid = syntax;
  s.rows = rows;
  s.columns = columns;
  s.samplesPerPixel = samples;
  s.bitsAllocated = allocated;
  s.bitsStored = stored;
  s.highBit = stored - 1;
  s.isSigned = isSigned;
  s.photometric = samples == 1 ? "MONOCHROME2" : "RGB";
  if (allocated <= 8) s.sample = isSigned ? SampleType::I8 : SampleType::U8;
  if (allocated == 16) s.sample = isSigned ? SampleType::I16 : SampleType::U16;
  if (allocated == 32) s.sample = isSigned ? SampleType::I32 : SampleType::U32;
  return s;
}

// Decoded samples of any container as 64-bit integers; floats bit by bit would make no sense here.
inline std::vector<std::int64_t> valuesOf(SampleType type, const Bytes& b) {
  std::vector<std::int64_t> v(b.size() / bytesOf(type));
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::byte* p = b.data() + i * bytesOf(type);
    const auto get = [&](auto x) {
      std::memcpy(&x, p, sizeof x);
      v[i] = static_cast<std::int64_t>(x);
    };
    switch (type) {
      case SampleType::U8:
        get(std::uint8_t{});
        break;
      case SampleType::I8:
        get(std::int8_t{});
        break;
      case SampleType::U16:
        get(std::uint16_t{});
        break;
      case SampleType::I16:
        get(std::int16_t{});
        break;
      case SampleType::U32:
        get(std::uint32_t{});
        break;
      case SampleType::I32:
        get(std::int32_t{});
        break;
      default:
        break;
    }
  }
  return v;
}

// As the expected facts count: every value as a little endian int32.
inline std::string sha256Int32(const std::vector<std::int64_t>& values) {
  std::vector<std::int32_t> v(values.size());
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = static_cast<std::int32_t>(values[i]);
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned n = 0;
  EVP_Digest(v.data(), v.size() * sizeof v[0], digest, &n, EVP_sha256(), nullptr);
  std::string hex;
  for (unsigned i = 0; i < n; ++i) {
    hex += "0123456789abcdef"[digest[i] >> 4];
    hex += "0123456789abcdef"[digest[i] & 15];
  }
  return hex;
}

}  // namespace vernier::test
