// SPDX-License-Identifier: GPL-3.0-or-later
#include "decode/PixelIndex.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "decode/Fragments.h"
#include "vernier/study/Limits.h"

namespace vernier::study {
namespace {

constexpr std::uint32_t kUndefined = 0xFFFFFFFF;
constexpr std::uint32_t kItem = 0xFFFEE000, kItemEnd = 0xFFFEE00D, kSequenceEnd = 0xFFFEE0DD;

struct Encoding {
  bool isExplicit = true;
  bool big = false;
};

struct ElementHeader {
  std::uint32_t tag = 0;  // group << 16 | element
  std::array<char, 2> vr{0, 0};
  std::uint32_t length = 0;
  std::uint64_t value = 0;  // offset of the value
  bool is(std::string_view name) const { return vr[0] == name[0] && vr[1] == name[1]; }
};

std::uint16_t u16(const std::byte* p, bool big) {
  const auto a = std::to_integer<std::uint16_t>(p[0]), b = std::to_integer<std::uint16_t>(p[1]);
  return static_cast<std::uint16_t>(big ? a << 8 | b : b << 8 | a);
}
std::uint32_t u32(const std::byte* p, bool big) {
  const std::uint32_t a = u16(p, big), b = u16(p + 2, big);
  return big ? a << 16 | b : b << 16 | a;
}

constexpr std::string_view kLongVrs = "OBODOFOLOVOWSQSVUCUNURUTUV";
constexpr std::string_view kShortVrs = "AEASATCSDADSDTFDFLISLOLTPNSHSLSSSTTMUIULUS";

bool oneOf(std::string_view list, char a, char b) {
  for (std::size_t i = 0; i + 1 < list.size(); i += 2)
    if (list[i] == a && list[i + 1] == b) return true;
  return false;
}

bool isUpper(char c) { return c >= 'A' && c <= 'Z'; }

Error damaged(std::uint64_t at) {
  return makeError(ErrorCode::FileDamaged, "The file's structure is damaged or cut short at byte " +
                                               std::to_string(at) +
                                               ", before its pixel data; fetch it again from its source.");
}

class Walker {
 public:
  explicit Walker(Source& s) : s_(s) {}

  // Header at `at`; false when it does not fit into the file or is no element.
  bool header(std::uint64_t at, Encoding e, ElementHeader& h) {
    std::array<std::byte, 12> b{};
    if (!s_.read(at, std::span(b).first(8))) return false;
    h.tag = static_cast<std::uint32_t>(u16(b.data(), e.big)) << 16 | u16(b.data() + 2, e.big);
    h.vr = {0, 0};
    h.value = at + 8;
    if (!e.isExplicit || h.tag >> 16 == 0xFFFE) {  // items and delimiters have no VR
      h.length = u32(b.data() + 4, e.big);
      return true;
    }
    h.vr = {std::to_integer<char>(b[4]), std::to_integer<char>(b[5])};
    // As the scan reads it (Header.cpp): an unknown VR has the long form, one that isn't two letters the
    // short.
    const bool longForm = !oneOf(kShortVrs, h.vr[0], h.vr[1]) && isUpper(h.vr[0]) && isUpper(h.vr[1]);
    if (!longForm) {
      h.length = u16(b.data() + 6, e.big);
      return true;
    }
    if (!s_.read(at + 8, std::span(b).subspan(8, 4))) return false;
    h.length = u32(b.data() + 8, e.big);
    h.value = at + 12;
    return true;
  }

  bool skippable(const ElementHeader& h) const {
    return h.value <= s_.size() && h.length <= s_.size() - h.value;
  }

  // Explicit when a known VR stands in the first element; big endian when its group is smaller read that way.
  Encoding guess(std::uint64_t at, Encoding declared) {
    std::array<std::byte, 6> b{};
    if (!s_.read(at, b)) return {};
    Encoding e;
    // A stray delimiter in front has no VR and says nothing about the encoding: what was declared counts.
    if (b[0] == std::byte{0xFE} && b[1] == std::byte{0xFF}) return declared;
    e.big = u16(b.data(), true) < u16(b.data(), false);
    const char v0 = std::to_integer<char>(b[4]), v1 = std::to_integer<char>(b[5]);
    e.isExplicit = oneOf(kShortVrs, v0, v1) || oneOf(kLongVrs, v0, v1);
    return e;
  }

  // From the first item of a sequence of undefined length to behind its delimiter.
  Result<std::uint64_t> skipSequence(std::uint64_t at, Encoding e);

 private:
  Source& s_;
};

// What the walk is inside of: a sequence (items follow) or an item of undefined length (elements follow).
struct Level {
  bool sequence;
  Encoding encoding;
};

Result<std::uint64_t> Walker::skipSequence(std::uint64_t at, Encoding e) {
  std::vector<Level> levels{{true, e}};
  while (!levels.empty()) {
    const Level level = levels.back();
    ElementHeader h;
    if (!header(at, level.encoding, h)) return damaged(at);
    if (h.tag == kSequenceEnd) {
      // Writers forget item delimiters; a sequence delimiter closes the item too.
      if (!level.sequence) levels.pop_back();
      levels.pop_back();
      at = h.value;
      continue;
    }
    if (level.sequence) {
      if (h.tag == kItemEnd) {
        at = h.value;
        continue;
      }
      if (h.tag != kItem) return damaged(at);
      if (h.length == kUndefined) levels.push_back({false, level.encoding});
    } else {
      if (h.tag == kItemEnd) {
        levels.pop_back();
        at = h.value;
        continue;
      }
      if (h.tag >> 16 == 0xFFFE) return damaged(at);
      // A sequence of VR UN with undefined length is written implicit little endian (PS3.5 6.2.2).
      if (h.length == kUndefined)
        levels.push_back({true, h.is("UN") ? Encoding{false, false} : level.encoding});
    }
    if (levels.size() > static_cast<std::size_t>(limits::kMaxSequenceDepth) * 2)
      return makeError(ErrorCode::LimitExceeded, "Sequences are nested deeper than the limit of " +
                                                     std::to_string(limits::kMaxSequenceDepth) + ".");
    if (h.length == kUndefined) {
      at = h.value;
    } else {
      if (!skippable(h)) return damaged(at);
      at = h.value + h.length;
    }
  }
  return at;
}

// Items of encapsulated pixel data. The first is the Basic Offset Table. A missing delimiter at the end of
// the file is let pass; an item that does not fit is not.
Result<void> listFragments(Walker& walker, Source& s, std::uint64_t at, Encoding e, PixelIndex& index,
                           Extent& table) {
  bool first = true;
  while (at != s.size()) {
    ElementHeader h;
    if (!walker.header(at, e, h)) {
      if (!index.fragments.empty()) return {};  // fewer than 8 stray bytes behind the last fragment
      return damaged(at);
    }
    if (h.tag == kSequenceEnd) return {};
    if (h.tag != kItem || h.length == kUndefined || !walker.skippable(h))
      return makeError(ErrorCode::FileDamaged, "The compressed pixel data is cut short or damaged at byte " +
                                                   std::to_string(at) +
                                                   "; fetch the file again from its source.");
    if (first)
      table = {h.value, h.length};
    else
      index.fragments.push_back({h.value, h.length});
    first = false;
    if (index.fragments.size() > limits::kMaxFragments)
      return makeError(ErrorCode::LimitExceeded, "The pixel data has more fragments than the limit of " +
                                                     std::to_string(limits::kMaxFragments) + ".");
    at = h.value + h.length;
  }
  return {};
}

Result<PixelIndex> indexFound(Walker& walker, Source& s, const ElementHeader& h, Encoding e,
                              const FrameSpec& spec) {
  PixelIndex index;
  index.element = static_cast<std::uint16_t>(h.tag & 0xFFFF);
  index.bigEndian = e.big;
  index.words = h.is("OW");
  index.encapsulated = h.length == kUndefined;
  if (!index.encapsulated) {
    index.value = {h.value, std::min<std::uint64_t>(h.length, s.size() - h.value)};
    return index;
  }
  Extent table;
  if (auto r = listFragments(walker, s, h.value, e, index, table); !r) return r.error();
  if (auto r = assignFragments(s, table, spec, index); !r) return r.error();
  return index;
}

}  // namespace

Result<std::uint64_t> dataSetOffset(Source& file) {
  std::array<std::byte, 132> start{};
  std::uint64_t at = 0;
  constexpr std::array<std::byte, 4> dicm{std::byte{'D'}, std::byte{'I'}, std::byte{'C'}, std::byte{'M'}};
  if (file.read(0, start) && std::equal(dicm.begin(), dicm.end(), start.begin() + 128)) at = 132;
  // The meta elements are walked one by one: the group length is often wrong.
  Walker walker(file);
  ElementHeader h;
  while (walker.header(at, {true, false}, h) && h.tag >> 16 == 0x0002) {
    if (!walker.skippable(h)) return damaged(at);
    at = h.value + h.length;
  }
  return at;
}

Result<PixelIndex> indexPixels(Source& source, std::uint64_t dataSetStart, const FrameSpec& spec) {
  Walker walker(source);
  const Encoding e = walker.guess(dataSetStart, {spec.transferSyntaxUid != "1.2.840.10008.1.2",
                                                 spec.transferSyntaxUid == "1.2.840.10008.1.2.2"});
  std::uint64_t at = dataSetStart;
  while (at < source.size()) {
    ElementHeader h;
    if (!walker.header(at, e, h)) return damaged(at);
    if (h.tag == 0x7FE00008 || h.tag == 0x7FE00009 || h.tag == 0x7FE00010)
      return indexFound(walker, source, h, e, spec);
    if (h.tag >> 16 == 0xFFFE) {  // stands outside of any sequence: passed over
      at = h.value;
      continue;
    }
    if (h.length == kUndefined) {
      const auto after = walker.skipSequence(h.value, h.is("UN") ? Encoding{false, false} : e);
      if (!after) return after.error();
      at = *after;
    } else {
      if (!walker.skippable(h)) return damaged(at);
      at = h.value + h.length;
    }
  }
  return makeError(ErrorCode::PixelDataMissing,
                   "The object has no pixel data, though its class is an image.");
}

}  // namespace vernier::study
