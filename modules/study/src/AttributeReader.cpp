// SPDX-License-Identifier: GPL-3.0-or-later
#include "AttributeReader.h"

#include <bit>
#include <cmath>

#include "Text.h"

namespace vernier {
namespace {

// More values than any attribute that is read this way has; grid vectors have one per frame.
constexpr std::size_t kMaxValues = 1'000'000;

std::uint64_t bits(std::span<const std::byte> bytes, bool bigEndian) {
  std::uint64_t v = 0;
  for (std::size_t b = 0; b < bytes.size(); ++b)
    v = v << 8 | std::to_integer<std::uint64_t>(bytes[bigEndian ? b : bytes.size() - 1 - b]);
  return v;
}

}  // namespace

AttributeReader::AttributeReader(const Header& h) : h_(&h), charset_(charsetOf(h.elements)) {}

AttributeReader::AttributeReader(const AttributeReader& outer, std::vector<Element> item)
    : h_(outer.h_), items_(std::move(item)), charset_(charsetOf(*items_)) {
  if (charset_.empty()) charset_ = outer.charset_;
}

std::string_view AttributeReader::raw(Tag t) const {
  const Element* e = element(t);
  return e ? rawText(*h_, *e) : std::string_view();
}

std::string AttributeReader::code(Tag t) const {
  std::string s(raw(t));
  for (char& c : s)
    if (static_cast<unsigned char>(c) >= 0x80 || static_cast<unsigned char>(c) < 0x20) c = '?';
  return s;
}

std::vector<std::string> AttributeReader::codes(Tag t) const { return splitValues(code(t)); }

std::string AttributeReader::decoded(std::string_view bytes, const std::vector<std::string>& charset,
                                     bool personName) {
  DecodedText d = decodeText(bytes, charset, personName);
  damaged_ = damaged_ || d.damaged;
  return std::move(d.utf8);
}

std::vector<double> AttributeReader::decimals(Tag t) const {
  std::vector<double> out;
  for (const std::string& v : splitValues(raw(t))) out.push_back(parseDecimal(v).value_or(std::nan("")));
  return out;
}

std::optional<double> AttributeReader::decimal(Tag t) const {
  const auto v = decimals(t);
  return v.empty() || std::isnan(v[0]) ? std::nullopt : std::optional(v[0]);
}

std::optional<std::int64_t> AttributeReader::integer(Tag t) const {
  const auto v = splitValues(raw(t));
  return v.empty() ? std::nullopt : parseInteger(v[0]);
}

std::vector<double> AttributeReader::doubles(Tag t) const {
  std::vector<double> out;
  const Element* e = element(t);
  if (!e) return out;
  const auto bytes = h_->value(*e);
  const bool single =
      e->is("FL") || (!e->is("FD") && bytes.size() == 4);  // in implicit encoding the size tells
  const std::size_t width = single ? 4 : 8;
  if (bytes.size() % width != 0) return out;
  for (std::size_t i = 0; i < bytes.size() && out.size() < kMaxValues; i += width) {
    const std::uint64_t v = bits(bytes.subspan(i, width), e->encoding.bigEndian);
    out.push_back(single ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(v)))
                         : std::bit_cast<double>(v));
  }
  return out;
}

std::vector<std::uint16_t> AttributeReader::words(Tag t) const {
  std::vector<std::uint16_t> out;
  const Element* e = element(t);
  for (std::size_t n = 0; e && n < e->length / 2 && n < kMaxValues; ++n) out.push_back(*word(*h_, *e, n));
  return out;
}

std::vector<std::uint32_t> AttributeReader::longs(Tag t) const {
  std::vector<std::uint32_t> out;
  const Element* e = element(t);
  if (!e) return out;
  const auto bytes = h_->value(*e);
  for (std::size_t i = 0; i + 4 <= bytes.size() && out.size() < kMaxValues; i += 4)
    out.push_back(e->is("AT") || t == 0x00280009 || t == 0x00209165
                      ? static_cast<std::uint32_t>(*word(*h_, *e, i / 2)) << 16 | *word(*h_, *e, i / 2 + 1)
                      : static_cast<std::uint32_t>(bits(bytes.subspan(i, 4), e->encoding.bigEndian)));
  return out;
}

std::vector<std::string> AttributeReader::charsetOf(const std::vector<Element>& elements) const {
  const Element* e = findIn(elements, 0x00080005);
  return e ? splitValues(rawText(*h_, *e)) : std::vector<std::string>();
}

std::vector<AttributeReader> AttributeReader::items(Tag sequence) const {
  std::vector<AttributeReader> out;
  if (const Element* e = element(sequence))
    for (auto& item : itemsOf(*h_, *e)) out.push_back(AttributeReader(*this, std::move(item)));
  return out;
}

std::optional<AttributeReader> AttributeReader::item(Tag sequence) const {
  const Element* e = element(sequence);
  if (!e) return std::nullopt;
  auto items = itemsOf(*h_, *e, 1);
  if (items.empty()) return std::nullopt;
  return AttributeReader(*this, std::move(items.front()));
}

}  // namespace vernier
