// SPDX-License-Identifier: GPL-3.0-or-later
#include "Header.h"

#include <algorithm>
#include <cstdio>

#include "HeaderElements.h"
#include "vernier/study/Limits.h"

namespace vernier {
using namespace elements;
namespace {

constexpr bool isPixelTag(Tag t) { return t == 0x7FE00010 || t == 0x7FE00008 || t == 0x7FE00009; }

Encoding declaredEncoding(const std::string& uid) {
  if (uid == "1.2.840.10008.1.2") return {false, false};
  if (uid == "1.2.840.10008.1.2.2") return {true, true};
  return {true, false};
}

// The encoding that the element at `at` is written in, from its own bytes.
std::optional<Encoding> seenEncoding(ByteSource& s, std::uint64_t at) {
  if (!s.ensure(at + 8)) return std::nullopt;
  const std::byte* p = s.bytes().data() + at;
  const bool isExplicit = knownVr(static_cast<char>(p[4]), static_cast<char>(p[5]));
  const bool big = p[0] == std::byte{0} && p[1] != std::byte{0} && p[1] < std::byte{0x80};
  return Encoding{isExplicit, isExplicit && big};
}

// Without the "DICM" mark: do three elements in ascending order follow, from group 2 or 8 on?
bool plausibleStart(ByteSource& s) {
  const auto e = seenEncoding(s, 0);
  if (!e) return false;
  std::uint64_t at = 0;
  Tag last = 0;
  for (int n = 0; n < 3; ++n) {
    const auto h = readHead(s, at, *e);
    if (!h || (n > 0 && h->tag <= last)) return false;
    const Tag group = h->tag >> 16;
    if (n == 0 && (group != 8 && !(group == 2 && e->explicitVr))) return false;
    if (n == 0 && (h->tag & 0xFFFF) > 0x0100) return false;
    if (group > 0x0028 || (e->explicitVr && !knownVr(h->vr[0], h->vr[1]))) return false;
    if (h->length > 1024 || h->value + h->length > s.limit()) return false;
    last = h->tag;
    at = h->value + h->length;
  }
  return true;
}

// The file meta information: explicit little endian whatever follows; its group length is not trusted.
std::uint64_t readMeta(ByteSource& s, std::uint64_t at, Header& out) {
  while (true) {
    const auto h = readHead(s, at, {true, false});
    if (!h || h->tag >> 16 != 2 || h->length > limits::kMaxNonPixelElementBytes) return at;
    if (!s.ensure(h->value + h->length)) return at;
    Element e;
    e.tag = h->tag;
    e.vr[0] = h->vr[0];
    e.vr[1] = h->vr[1];
    e.offset = h->value;
    e.length = h->length;
    out.meta.push_back(e);
    if (e.tag == 0x00020010) {
      const auto v = s.bytes().subspan(e.offset, e.length);
      std::string_view text(reinterpret_cast<const char*>(v.data()), v.size());
      while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.remove_suffix(1);
      out.transferSyntaxUid = std::string(text);
    }
    at = h->value + h->length;
  }
}

bool onlyZeros(ByteSource& s, std::uint64_t at) {
  const auto rest = s.bytes().subspan(std::min<std::uint64_t>(at, s.bytes().size()));
  return std::all_of(rest.begin(), rest.end(), [](std::byte b) { return b == std::byte{0}; });
}

// The data set from `at` to the pixel data or the end.
void readDataset(ByteSource& s, std::uint64_t at, Header& out) {
  while (true) {
    if (at > limits::kMaxHeaderBytes || out.elements.size() >= limits::kMaxElements) {
      out.damage = makeError(ErrorCode::LimitExceeded,
                             "The header is larger than the limits of " +
                                 std::to_string(limits::kMaxHeaderBytes >> 20) + " MiB and " +
                                 std::to_string(limits::kMaxElements) + " elements; the file is refused.");
      return;
    }
    const auto h = readHead(s, at, out.encoding);
    if (!h) {
      if (s.failure())
        out.damage = s.failure();
      else if (s.bytes().size() > at && !onlyZeros(s, at))
        out.damage = damaged("The file ends inside an element; it was cut short, fetch it again.");
      return;
    }
    if (h->tag >> 16 == 0xFFFE) {
      out.strayDelimiters = true;
      at = h->value;
      continue;
    }
    if (h->tag == 0 && h->length == 0 && onlyZeros(s, at)) return;  // padding behind the last element
    Element e;
    e.tag = h->tag;
    e.vr[0] = h->vr[0];
    e.vr[1] = h->vr[1];
    e.offset = h->value;
    e.encoding = contentEncoding(*h, out.encoding);
    e.undefinedLength = h->length == kUndefined;
    if (isPixelTag(e.tag)) {
      PixelElement p{e, e.undefinedLength, s.limit() - std::min(s.limit(), h->value)};
      if (!p.encapsulated) {
        p.element.length = h->length;
        // Of a file we know its size without reading on; what is deflated must be counted by inflating it.
        const bool all = h->value + h->length <= s.limit() &&
                         (s.limit() != limits::kMaxInflatedBytes || s.ensure(h->value + h->length));
        const std::uint64_t end = s.limit() != limits::kMaxInflatedBytes ? s.limit() : s.bytes().size();
        p.bytesThere = all ? h->length : end - std::min(end, h->value);
      }
      out.pixels = p;
      return;
    }
    if (e.undefinedLength) {
      const auto skipped = skipSequence(s, h->value, *h, out.encoding);
      if (!skipped) {
        out.damage = s.failure() ? s.failure() : skipped.error();
        return;
      }
      e.length = skipped->contentEnd - e.offset;
      at = skipped->next;
    } else {
      if (h->length > s.limit() - std::min(s.limit(), h->value)) {
        out.damage = cutShort(e.tag);
        out.damage->sentence = "Element " + tagText(e.tag) + " declares " + std::to_string(h->length) +
                               " bytes, but the file holds " +
                               std::to_string(s.limit() - std::min(s.limit(), h->value)) +
                               " more; it was cut short or damaged, fetch it again.";
        return;
      }
      if (h->length > limits::kMaxNonPixelElementBytes) {
        out.damage = makeError(ErrorCode::LimitExceeded,
                               "Element " + tagText(e.tag) + " is larger than the limit of " +
                                   std::to_string(limits::kMaxNonPixelElementBytes >> 20) +
                                   " MiB; the file is refused.");
        return;
      }
      if (!s.ensure(h->value + h->length)) {
        out.damage = s.failure() ? *s.failure() : cutShort(e.tag);
        return;
      }
      e.length = h->length;
      at = h->value + h->length;
    }
    out.elements.push_back(e);
  }
}

}  // namespace

Result<Header> readHeader(ByteSource& source) {
  Header out;
  std::uint64_t at = 0;
  if (source.ensure(132)) {
    const auto mark = source.bytes().subspan(128, 4);
    out.part10 = mark[0] == std::byte{'D'} && mark[1] == std::byte{'I'} && mark[2] == std::byte{'C'} &&
                 mark[3] == std::byte{'M'};
  }
  if (source.limit() == 0) return makeError(ErrorCode::NotDicom, "The file is empty.");
  if (out.part10)
    at = 132;
  else if (!plausibleStart(source))
    return makeError(ErrorCode::NotDicom,
                     "This is not a DICOM file: it has neither the DICM mark nor a start that "
                     "reads as DICOM; leave it out.");
  out.elements.reserve(96);
  at = readMeta(source, at, out);
  std::unique_ptr<ByteSource> inflated;
  ByteSource* s = &source;
  if (out.transferSyntaxUid == "1.2.840.10008.1.2.1.99") {
    // Offsets in `meta` point into the file, which is not kept: the transfer syntax is all that is needed of
    // it.
    out.meta.clear();
    inflated = inflateSource(source, at);
    s = inflated.get();
    at = 0;
  }
  out.encoding = declaredEncoding(out.transferSyntaxUid);
  if (const auto seen = seenEncoding(*s, at)) {
    const bool differs =
        seen->explicitVr != out.encoding.explicitVr || seen->bigEndian != out.encoding.bigEndian;
    // A stray delimiter in front has no VR and says nothing about the encoding.
    const bool delimiter = s->bytes()[at] == std::byte{0xFE} && s->bytes()[at + 1] == std::byte{0xFF};
    if (differs && !delimiter) {
      out.contradictsSyntax = !out.transferSyntaxUid.empty();
      out.encoding = *seen;
    }
  } else if (out.part10) {
    out.damage = s->failure()
                     ? *s->failure()
                     : damaged("The file ends behind its file meta information; it holds no object.");
  }
  if (!out.damage) readDataset(*s, at, out);
  out.bytes = s->take();
  return out;
}

const Element* findIn(const std::vector<Element>& item, Tag tag) {
  for (const Element& e : item)
    if (e.tag == tag) return &e;
  return nullptr;
}
const Element* Header::find(Tag tag) const { return findIn(elements, tag); }

namespace {
// The elements of one item, to `end` or its delimiter; returns where reading stopped.
std::uint64_t readItem(ByteSource& s, std::uint64_t at, std::uint64_t end, Encoding e,
                       std::vector<Element>& out) {
  while (at + 8 <= end) {
    const auto h = readHead(s, at, e);
    if (!h) return end;
    if (h->tag == kItemEnd) return h->value;
    if (h->tag == kSequenceEnd) return at;
    Element el;
    el.tag = h->tag;
    el.vr[0] = h->vr[0];
    el.vr[1] = h->vr[1];
    el.offset = h->value;
    el.encoding = contentEncoding(*h, e);
    el.undefinedLength = h->length == kUndefined;
    if (el.undefinedLength) {
      const auto skipped = skipSequence(s, h->value, *h, e);
      if (!skipped) return end;
      el.length = skipped->contentEnd - el.offset;
      at = skipped->next;
    } else {
      if (h->length > end - std::min(end, h->value)) return end;
      el.length = h->length;
      at = h->value + h->length;
    }
    out.push_back(el);
  }
  return end;
}
}  // namespace

std::vector<std::vector<Element>> itemsOf(const Header& header, const Element& sequence, std::size_t most) {
  std::vector<std::vector<Element>> items;
  const auto source = memorySource(header.bytes);
  ByteSource& s = *source;
  const std::uint64_t end = sequence.offset + sequence.length;
  std::uint64_t at = sequence.offset;
  while (at + 8 <= end && items.size() < most) {
    const auto h = readHead(s, at, sequence.encoding);
    if (!h || h->tag != kItem) break;
    const bool open = h->length == kUndefined;
    // An item that claims more than its sequence holds gives what is there.
    const std::uint64_t itemEnd = open ? end : h->value + std::min<std::uint64_t>(h->length, end - h->value);
    items.emplace_back();
    const std::uint64_t stop = readItem(s, h->value, itemEnd, sequence.encoding, items.back());
    at = open ? stop : itemEnd;
  }
  return items;
}

std::optional<std::uint16_t> word(const Header& h, const Element& e, std::size_t n) {
  if (e.length < 2 * (n + 1)) return std::nullopt;
  return u16(h.bytes.data() + e.offset + 2 * n, e.encoding.bigEndian);
}

std::string_view rawText(const Header& h, const Element& e) {
  std::string_view t(reinterpret_cast<const char*>(h.bytes.data() + e.offset), e.length);
  while (!t.empty() && (t.back() == ' ' || t.back() == '\0')) t.remove_suffix(1);
  while (!t.empty() && t.front() == ' ') t.remove_prefix(1);
  return t;
}

std::string tagText(Tag t) {
  char text[16];
  std::snprintf(text, sizeof text, "(%04X,%04X)", t >> 16, t & 0xFFFF);
  return text;
}

}  // namespace vernier
