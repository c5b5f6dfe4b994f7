// SPDX-License-Identifier: GPL-3.0-or-later
// Attributes of a data set or of one sequence item as values: text in UTF-8, numbers as numbers, items as
// readers of their own. Nothing here fails: what is missing or malformed is empty or nullopt. Readers refer
// to the Header, which must outlive them.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "Header.h"

namespace vernier {

class AttributeReader {
 public:
  explicit AttributeReader(const Header& h);

  const Header& header() const { return *h_; }
  const std::vector<Element>& elements() const { return items_ ? *items_ : h_->elements; }
  const Element* element(Tag t) const { return findIn(elements(), t); }
  bool has(Tag t) const { return element(t) != nullptr; }

  std::string_view raw(Tag) const;
  // Codes, UIDs, dates: no character set applies. Bytes beyond ASCII would not be valid UTF-8.
  std::string code(Tag) const;
  std::vector<std::string> codes(Tag) const;
  std::string text(Tag t, bool personName = false) { return decoded(raw(t), charset_, personName); }
  std::string decoded(std::string_view bytes, const std::vector<std::string>& charset, bool personName);
  bool textDamaged() const { return damaged_; }

  std::vector<double> decimals(Tag) const;  // DS; a value that is no number is NaN
  std::optional<double> decimal(Tag) const;
  std::optional<std::int64_t> integer(Tag) const;  // IS
  std::vector<double> doubles(Tag) const;          // FD, FL
  std::vector<std::uint16_t> words(Tag) const;     // US, SS
  std::vector<std::uint32_t> longs(Tag) const;     // UL, AT (group << 16 | element)
  std::vector<std::string> charsetOf(const std::vector<Element>&) const;
  const std::vector<std::string>& charset() const { return charset_; }

  // The items of a sequence; an item without a character set of its own has this one's.
  std::vector<AttributeReader> items(Tag sequence) const;
  std::optional<AttributeReader> item(Tag sequence) const;  // the first

 private:
  AttributeReader(const AttributeReader& outer, std::vector<Element> item);

  const Header* h_;
  std::optional<std::vector<Element>> items_;  // of an item; a data set's stand in the header
  std::vector<std::string> charset_;
  bool damaged_ = false;
};

}  // namespace vernier
