// SPDX-License-Identifier: GPL-3.0-or-later
#include "Luts.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace vernier {
namespace {

struct Descriptor {
  std::size_t entries = 0;
  double firstMapped = 0;
  std::uint32_t bits = 0;
};

std::optional<Descriptor> descriptorOf(const Header& h, const Element* e, bool signedInput) {
  if (!e || e->length < 6) return std::nullopt;
  Descriptor d;
  const std::uint16_t declared = *word(h, *e, 0), first = *word(h, *e, 1);
  d.entries = declared == 0 ? 65536 : declared;
  const bool isSigned = e->is("SS") || (!e->is("US") && signedInput);
  d.firstMapped = isSigned ? static_cast<std::int16_t>(first) : first;
  d.bits = *word(h, *e, 2);
  return d;
}

// Entry n of a table that packs two into each word: the low byte comes first, whatever the byte order.
std::uint16_t packedEntry(const Header& h, const Element& e, std::size_t n) {
  if (!e.is("OW") || !e.encoding.bigEndian) return std::to_integer<std::uint16_t>(h.value(e)[n]);
  const auto w = word(h, e, n / 2);
  return w ? static_cast<std::uint16_t>(n % 2 == 0 ? *w & 0xFF : *w >> 8) : std::uint16_t{0};
}

// One entry for each word; tables of at most 8 bits may pack two into a word.
std::optional<std::vector<std::uint16_t>> entriesOf(const Header& h, const Element* e, const Descriptor& d) {
  if (!e) return std::nullopt;
  std::vector<std::uint16_t> out;
  if (e->length / 2 >= d.entries) {
    out.reserve(d.entries);
    for (std::size_t n = 0; n < d.entries; ++n) out.push_back(*word(h, *e, n));
  } else if (d.bits <= 8 && e->length >= d.entries) {
    out.reserve(d.entries);
    for (std::size_t n = 0; n < d.entries; ++n) out.push_back(packedEntry(h, *e, n));
  } else {
    return std::nullopt;
  }
  return out;
}

std::vector<std::uint16_t> unitsOf(const Header& h, const Element& e, bool bytes) {
  std::vector<std::uint16_t> out;
  const std::size_t n = bytes ? e.length : e.length / 2;
  for (std::size_t i = 0; i < n; ++i) out.push_back(bytes ? packedEntry(h, e, i) : *word(h, e, i));
  return out;
}

Error paletteError(const std::string& what) {
  return makeError(ErrorCode::PixelDescriptionInvalid,
                   what + " The colours of the image are not known, so it cannot be shown.",
                   "Palette Color Lookup Table (0028,1101-1223)");
}

constexpr Tag kDescriptor = 0x00281101, kData = 0x00281201, kSegmented = 0x00281221;
constexpr const char* kChannels[3] = {"red", "green", "blue"};

Result<std::vector<std::uint16_t>> channelOf(const Header& h, std::size_t c, const Descriptor& d) {
  const Tag offset = static_cast<Tag>(c);
  const Element *plain = h.find(kData + offset), *segmented = h.find(kSegmented + offset);
  const std::string name = kChannels[c];
  if (plain) {
    if (auto values = entriesOf(h, plain, d)) return std::move(*values);
    return paletteError("The " + name + " palette declares " + std::to_string(d.entries) +
                        " entries, but has only " + std::to_string(plain->length) + " bytes.");
  }
  if (!segmented) return paletteError("The " + name + " palette is missing.");
  const bool bytes = d.bits == 8;
  if (auto values = expandSegments(unitsOf(h, *segmented, bytes), d.entries, bytes))
    return std::move(*values);
  return paletteError("The segments of the " + name + " palette do not make the " +
                      std::to_string(d.entries) + " entries that it declares.");
}

// Some writers store 8-bit entries and call them 16-bit ones: the image would be black. Others write 8-bit
// values into the high bytes: 0xFF00 is full intensity.
void settleScale(Palette& p, std::string& corrected) {
  std::uint16_t most = 0, low = 0;
  for (const auto& e : p.entries)
    for (const std::uint16_t v : e)
      most = std::max(most, v), low = static_cast<std::uint16_t>(low | (v & 0xFF));
  if (p.bits == 16 && most > 0 && most <= 255) {
    p.bits = 8;
    corrected = "The palette says 16 bits for entries that are all below 256; 8 bits are taken. ";
  }
  p.fullScale = p.bits == 8 ? 255 : low == 0 ? 0xFF00 : 0xFFFF;
}

class Expander {
 public:
  Expander(const std::vector<std::uint16_t>& data, std::size_t entries, bool eightBit)
      : data_(data), entries_(entries), eightBit_(eightBit) {}

  bool run() {
    std::size_t at = 0;
    while (out_.size() < entries_ && at + 1 < data_.size())
      if (!segment(at, true)) return false;
    return out_.size() == entries_;
  }
  std::vector<std::uint16_t> take() { return std::move(out_); }

 private:
  bool put(std::uint16_t v) {
    if (out_.size() >= entries_) return false;
    out_.push_back(v);
    return true;
  }
  bool segment(std::size_t& at, bool mayPointBack) {
    if (at + 1 >= data_.size()) return false;
    const std::uint16_t opcode = data_[at], length = data_[at + 1];
    at += 2;
    if (opcode == 0) return discrete(at, length);
    if (opcode == 1) return linear(at, length);
    return opcode == 2 && mayPointBack && indirect(at, length);
  }
  bool discrete(std::size_t& at, std::size_t length) {
    if (length > data_.size() - at) return false;
    for (std::size_t n = 0; n < length; ++n)
      if (!put(data_[at + n])) return false;
    at += length;
    return true;
  }
  // From the last value, which is there already, in even steps to the one given.
  bool linear(std::size_t& at, std::size_t length) {
    if (at >= data_.size() || out_.empty() || length == 0) return false;
    const double from = out_.back(), to = data_[at++];
    for (std::size_t n = 1; n <= length; ++n)
      if (!put(static_cast<std::uint16_t>(
              std::floor(from + (to - from) * static_cast<double>(n) / static_cast<double>(length) + 0.5))))
        return false;
    return true;
  }
  // Segments of earlier in the table once more: their number, and the byte offset of the first as two halves.
  bool indirect(std::size_t& at, std::size_t segments) {
    const std::size_t units = eightBit_ ? 4 : 2;
    if (at + units > data_.size()) return false;
    std::size_t offset = 0;
    for (std::size_t n = units; n-- > 0;) offset = offset << (eightBit_ ? 8 : 16) | data_[at + n];
    at += units;
    std::size_t from = eightBit_ ? offset : offset / 2;
    for (std::size_t n = 0; n < segments; ++n)
      if (from >= data_.size() || !segment(from, false)) return false;
    return true;
  }

  const std::vector<std::uint16_t>& data_;
  std::size_t entries_;
  bool eightBit_;
  std::vector<std::uint16_t> out_;
};

}  // namespace

std::optional<std::vector<std::uint16_t>> expandSegments(const std::vector<std::uint16_t>& data,
                                                         std::size_t entries, bool eightBit) {
  Expander expander(data, entries, eightBit);
  if (!expander.run()) return std::nullopt;
  return expander.take();
}

std::optional<LutTable> lutFrom(const Header& h, const std::vector<Element>& item, bool signedInput) {
  const auto d = descriptorOf(h, findIn(item, 0x00283002), signedInput);
  if (!d || d->bits == 0 || d->bits > 16) return std::nullopt;
  auto values = entriesOf(h, findIn(item, 0x00283006), *d);
  if (!values) return std::nullopt;
  LutTable lut;
  lut.firstMapped = d->firstMapped;
  lut.bits = d->bits;
  lut.data = std::move(*values);
  return lut;
}

Result<PaletteResult> paletteFrom(const Header& h, bool signedIndex) {
  Palette p;
  std::optional<Descriptor> first;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto d = descriptorOf(h, h.find(kDescriptor + static_cast<Tag>(c)), signedIndex);
    if (!d) return paletteError(std::string("The ") + kChannels[c] + " palette has no descriptor.");
    if (d->bits != 8 && d->bits != 16)
      return paletteError("The entries of the palette have " + std::to_string(d->bits) +
                          " bits, where 8 or 16 can be.");
    if (first &&
        (d->entries != first->entries || d->firstMapped != first->firstMapped || d->bits != first->bits))
      return paletteError("The descriptors of the red, green and blue palettes differ.");
    if (!first) {
      first = d;
      p.firstMapped = d->firstMapped;
      p.bits = d->bits;
      p.entries.resize(d->entries);
    }
    const auto values = channelOf(h, c, *d);
    if (!values) return values.error();
    for (std::size_t n = 0; n < values->size(); ++n) p.entries[n][c] = (*values)[n];
  }
  PaletteResult out;
  settleScale(p, out.corrected);
  if (p.bits == 8)
    for (const auto& e : p.entries)
      for (const std::uint16_t v : e)
        if (v > 255) return paletteError("The palette has entries above 255 where it declares 8 bits.");
  out.palette = std::make_shared<const Palette>(std::move(p));
  return out;
}

}  // namespace vernier
