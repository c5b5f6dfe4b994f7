// SPDX-License-Identifier: GPL-3.0-or-later
#include "HeaderElements.h"

#include <algorithm>
#include <array>

#include "vernier/study/Limits.h"

namespace vernier::elements {
namespace {

constexpr std::string_view kShortVrs = "AEASATCSDADSDTFLFDISLOLTPNSHSLSSSTTMUIULUS";
constexpr std::string_view kLongVrs = "OBODOFOLOVOWSQSVUCUNURUTUV";
bool inList(std::string_view list, char a, char b) {
  for (std::size_t i = 0; i + 1 < list.size(); i += 2)
    if (list[i] == a && list[i + 1] == b) return true;
  return false;
}
bool isUpper(char c) { return c >= 'A' && c <= 'Z'; }

std::uint32_t u32(const std::byte* p, bool big) {
  const std::uint32_t a = u16(p, big), b = u16(p + 2, big);
  return big ? a << 16 | b : b << 16 | a;
}

bool holdsFragments(const Head& h) { return h.vr[0] == 'O'; }  // OB, OW...: encapsulated frames

}  // namespace

bool knownVr(char a, char b) { return inList(kShortVrs, a, b) || inList(kLongVrs, a, b); }

std::uint16_t u16(const std::byte* p, bool big) {
  const auto a = std::to_integer<std::uint16_t>(p[0]), b = std::to_integer<std::uint16_t>(p[1]);
  return static_cast<std::uint16_t>(big ? a << 8 | b : b << 8 | a);
}

std::optional<Head> readHead(ByteSource& s, std::uint64_t at, Encoding e) {
  if (!s.ensure(at + 8)) return std::nullopt;
  const std::byte* p = s.bytes().data() + at;
  Head h;
  h.tag = static_cast<Tag>(u16(p, e.bigEndian)) << 16 | u16(p + 2, e.bigEndian);
  h.value = at + 8;
  const bool delimiter = h.tag >> 16 == 0xFFFE;
  if (!e.explicitVr || delimiter) {
    h.length = u32(p + 4, e.bigEndian);
    return h;
  }
  h.vr[0] = static_cast<char>(p[4]);
  h.vr[1] = static_cast<char>(p[5]);
  // A VR that isn't known yet has the long form (PS3.5 7.1.2); one that isn't two letters is a writer's
  // fault, and such writers use the short form.
  const bool longForm = !inList(kShortVrs, h.vr[0], h.vr[1]) && isUpper(h.vr[0]) && isUpper(h.vr[1]);
  if (!longForm) {
    h.length = u16(p + 6, e.bigEndian);
    return h;
  }
  if (!s.ensure(at + 12)) return std::nullopt;
  h.length = u32(s.bytes().data() + at + 8, e.bigEndian);
  h.value = at + 12;
  return h;
}

Error damaged(std::string sentence) { return makeError(ErrorCode::FileDamaged, std::move(sentence)); }
Error cutShort(Tag tag) {
  return damaged("The file ends inside " + tagText(tag) + "; it was cut short, fetch it again.");
}

Encoding contentEncoding(const Head& h, Encoding e) {
  if (e.explicitVr && h.vr[0] == 'U' && h.vr[1] == 'N') return {false, false};
  return e;
}

// A loop over a counted stack of levels.
Result<Skipped> skipSequence(ByteSource& s, std::uint64_t at, const Head& sequence, Encoding outer) {
  struct Level {
    bool items;      // expects items; else the elements of one item
    bool fragments;  // its items are plain bytes
    Encoding encoding;
  };
  std::array<Level, 2 * limits::kMaxSequenceDepth + 2> level;
  std::size_t depth = 1;
  level[0] = {true, holdsFragments(sequence), contentEncoding(sequence, outer)};
  while (true) {
    const Level now = level[depth - 1];
    const auto h = readHead(s, at, now.encoding);
    if (!h) return cutShort(sequence.tag);
    if (h->tag == kSequenceEnd) {
      // Writers forget item delimiters; a sequence delimiter closes the item too.
      while (depth > 0 && !level[depth - 1].items) --depth;
      if (depth > 0) --depth;
      if (depth == 0) return Skipped{at, h->value};
      at = h->value;
      continue;
    }
    if (h->tag == kItemEnd) {
      if (!now.items) --depth;
      at = h->value;
      continue;
    }
    const bool opens = h->length == kUndefined;
    if (!opens) {
      if (h->length > s.limit() - std::min(s.limit(), h->value)) return cutShort(h->tag);
      at = h->value + h->length;
      continue;
    }
    if (now.items && (h->tag != kItem || now.fragments))
      return damaged("A sequence in " + tagText(sequence.tag) +
                     " holds something that is no item; the file is damaged.");
    if (depth >= level.size() || depth >= 2 * static_cast<std::size_t>(limits::kMaxSequenceDepth))
      return makeError(ErrorCode::LimitExceeded,
                       "Sequences are nested deeper than " + std::to_string(limits::kMaxSequenceDepth) +
                           " levels, which no real object is; the file is refused.");
    level[depth++] = now.items ? Level{false, false, now.encoding}
                               : Level{true, holdsFragments(*h), contentEncoding(*h, now.encoding)};
    at = h->value;
  }
}

}  // namespace vernier::elements
