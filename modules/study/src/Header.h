// SPDX-License-Identifier: GPL-3.0-or-later
// The header of a DICOM file as a flat list of top-level elements, read without recursion and without
// trusting any length: PS3.5 section 7 (encodings), PS3.10 section 7 (file meta information). Reading stops
// at the pixel data. Why not DCMTK here: its reader recurses per nesting level and allocates what an element
// declares; a scan looks at thousands of files of unknown origin, wants a few dozen attributes of each, and
// must stay far below a millisecond.
#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ByteSource.h"
#include "vernier/base/Result.h"

namespace vernier {

using Tag = std::uint32_t;  // group << 16 | element

struct Encoding {
  bool explicitVr = true;
  bool bigEndian = false;
};

struct Element {
  Tag tag = 0;
  char vr[2] = {' ', ' '};  // spaces in implicit encoding
  bool undefinedLength = false;
  Encoding encoding;         // of what it holds
  std::uint64_t offset = 0;  // of the value in Header::bytes
  std::uint64_t length = 0;  // bytes of the value, without the closing delimiter
  bool is(const char* v) const { return vr[0] == v[0] && vr[1] == v[1]; }
};

struct PixelElement {
  Element element;
  bool encapsulated = false;
  std::uint64_t bytesThere =
      0;  // native: how many of `length` the file holds; encapsulated: all up to its end
};

struct Header {
  std::vector<std::byte> bytes;
  std::vector<Element> meta, elements;  // in file order
  std::string transferSyntaxUid;        // "" when none is declared
  Encoding encoding;                    // as found, which may contradict the declaration
  bool part10 = false;                  // "DICM" at 128
  bool contradictsSyntax = false;       // encoding found differs from what was declared
  bool strayDelimiters = false;         // item or delimiter tags outside of any sequence were skipped
  std::optional<PixelElement> pixels;
  std::optional<Error> damage;  // reading stopped here; what came before stands

  std::span<const std::byte> value(const Element& e) const {
    return std::span(bytes).subspan(e.offset, e.length);
  }
  const Element* find(Tag) const;  // the first of that tag
};

// NotDicom when it doesn't look like DICOM at all. Any other trouble stands in Header::damage.
Result<Header> readHeader(ByteSource& source);

// The items of a sequence (nested sequences inside them are skipped over whole), at most `most`. Damaged
// parts are left out.
std::vector<std::vector<Element>> itemsOf(const Header&, const Element& sequence,
                                          std::size_t most = std::numeric_limits<std::size_t>::max());
const Element* findIn(const std::vector<Element>& item, Tag);

// Unsigned and signed 16 bit value n of an element in its byte order; nullopt when it isn't there.
std::optional<std::uint16_t> word(const Header&, const Element&, std::size_t n = 0);
std::string_view rawText(const Header&, const Element&);  // without trailing spaces and zeros
std::string tagText(Tag);                                 // "(0028,0010)"

}  // namespace vernier
