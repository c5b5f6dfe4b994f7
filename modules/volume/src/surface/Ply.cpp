// SPDX-License-Identifier: GPL-3.0-or-later
// PLY 1.0: text and binary of both byte orders. Any elements and properties are walked over; x, y, z of
// `vertex` and the list vertex_indices (or vertex_index) of `face` are used.
#include <algorithm>
#include <bit>
#include <cstring>

#include "Readers.h"
#include "TextTokens.h"
#include "vernier/base/Checked.h"

namespace vernier::surface {
namespace {

enum class Type { I8, U8, I16, U16, I32, U32, F32, F64 };

std::optional<Type> typeOf(std::string_view name) {
  struct Row {
    std::string_view old, sized;
    Type type;
  };
  constexpr Row rows[] = {{"char", "int8", Type::I8},      {"uchar", "uint8", Type::U8},
                          {"short", "int16", Type::I16},   {"ushort", "uint16", Type::U16},
                          {"int", "int32", Type::I32},     {"uint", "uint32", Type::U32},
                          {"float", "float32", Type::F32}, {"double", "float64", Type::F64}};
  for (const Row& r : rows)
    if (name == r.old || name == r.sized) return r.type;
  return std::nullopt;
}
std::size_t bytesOf(Type t) {
  constexpr std::size_t bytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return bytes[static_cast<std::size_t>(t)];
}

struct Property {
  std::string name;
  Type type = Type::F32;
  std::optional<Type> count;  // of a list
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
  std::uint64_t leastBytes(bool text) const {
    std::uint64_t n = 0;
    for (const Property& p : properties) n += text ? 2 : bytesOf(p.count ? *p.count : p.type);
    return n;
  }
};
enum class Coding { Text, Little, Big };
struct Header {
  Coding coding = Coding::Text;
  std::vector<Element> elements;
  std::size_t end = 0;    // offset of the first byte after "end_header\n"
  std::size_t lines = 0;  // of the header
};

class HeaderReader {
 public:
  explicit HeaderReader(std::string_view bytes) : bytes_(bytes) {}

  Result<Header> read() {
    if (nextLine() != "ply")
      return makeError(ErrorCode::FormatUnknown, "This is no PLY file: its first line is not 'ply'.");
    bool coded = false;
    while (at_ < bytes_.size()) {
      const std::string_view line = nextLine();
      TextTokens words(line, "", '\0');
      const std::string_view key = words.next();
      if (key == "end_header") {
        h_.end = at_;
        return coded ? Result<Header>(std::move(h_)) : Result<Header>(damaged("No line says the format."));
      }
      if (key.empty() || key == "comment" || key == "obj_info") continue;
      Result<void> ok;
      if (key == "format")
        ok = readFormat(words), coded = true;
      else if (key == "element")
        ok = readElement(words);
      else if (key == "property")
        ok = readProperty(words);
      else
        ok = damaged(shown(key) + " is no word of a PLY header.");
      if (!ok) return ok.error();
    }
    return damaged("The header has no 'end_header'; the file is cut short.");
  }

 private:
  // Lines end with \n, \r\n or \r.
  std::string_view nextLine() {
    const std::size_t begin = at_, end = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
    at_ = std::min(end + 1, bytes_.size());
    if (end + 1 < bytes_.size() && bytes_[end] == '\r' && bytes_[end + 1] == '\n') ++at_;
    ++h_.lines;
    return bytes_.substr(begin, end - begin);
  }
  Error damaged(const std::string& sentence) const {
    return makeError(ErrorCode::FileDamaged, "Line " + std::to_string(h_.lines) + ": " + sentence);
  }
  Result<void> readFormat(TextTokens& words) {
    const std::string_view name = words.next();
    if (name == "ascii")
      h_.coding = Coding::Text;
    else if (name == "binary_little_endian")
      h_.coding = Coding::Little;
    else if (name == "binary_big_endian")
      h_.coding = Coding::Big;
    else
      return damaged("The format " + shown(name) + " is not known.");
    if (words.next() != "1.0") return damaged("Only version 1.0 of PLY exists.");
    return {};
  }
  Result<void> readElement(TextTokens& words) {
    Element e;
    e.name = std::string(words.next().substr(0, 64));
    const auto n = asInteger(words.next());
    if (e.name.empty() || !n || *n < 0) return damaged("An element has a name and a count.");
    e.count = static_cast<std::uint64_t>(*n);
    h_.elements.push_back(std::move(e));
    if (h_.elements.size() > 64) return damaged("A header of more than 64 elements is not read.");
    return {};
  }
  Result<void> readProperty(TextTokens& words) {
    if (h_.elements.empty()) return damaged("A property stands before the first element.");
    Property p;
    std::string_view word = words.next();
    if (word == "list") {
      p.count = typeOf(words.next());
      if (!p.count || *p.count == Type::F32 || *p.count == Type::F64)
        return damaged("The type of a list's count is not whole.");
      word = words.next();
    }
    const auto type = typeOf(word);
    if (!type) return damaged("The property type " + shown(word) + " is not known.");
    p.type = *type;
    p.name = std::string(words.next().substr(0, 64));
    std::vector<Property>& all = h_.elements.back().properties;
    all.push_back(std::move(p));
    if (all.size() > 256) return damaged("An element of more than 256 properties is not read.");
    return {};
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  Header h_;
};

// Numbers of the body one by one; nothing at the end.
class Body {
 public:
  Body(std::string_view bytes, Coding coding) : bytes_(bytes), coding_(coding), words_(bytes, "", '\0') {}

  std::optional<double> next(Type type) {
    if (coding_ == Coding::Text) return asNumber(words_.next());
    const std::size_t n = bytesOf(type);
    if (bytes_.size() - at_ < n) return std::nullopt;
    const bool swapped = (coding_ == Coding::Big) != (std::endian::native == std::endian::big);
    char raw[8];
    for (std::size_t i = 0; i < n; ++i) raw[i] = bytes_[at_ + (swapped ? n - 1 - i : i)];
    at_ += n;
    switch (type) {
      case Type::I8:
        return as<std::int8_t>(raw);
      case Type::U8:
        return as<std::uint8_t>(raw);
      case Type::I16:
        return as<std::int16_t>(raw);
      case Type::U16:
        return as<std::uint16_t>(raw);
      case Type::I32:
        return as<std::int32_t>(raw);
      case Type::U32:
        return as<std::uint32_t>(raw);
      case Type::F32:
        return as<float>(raw);
      case Type::F64:
        return as<double>(raw);
    }
    return std::nullopt;
  }
  // A whole number at or above 0, below 2^32.
  std::optional<std::uint32_t> index(Type type) {
    const auto x = next(type);
    if (!x || !(*x >= 0) || *x > 4294967295.0 || *x != std::floor(*x)) return std::nullopt;
    return static_cast<std::uint32_t>(*x);
  }
  std::uint64_t left() const {
    return coding_ == Coding::Text ? bytes_.size() - words_.offset() : bytes_.size() - at_;
  }
  std::uint64_t leastBytes(std::uint64_t values, Type type) const {
    return coding_ == Coding::Text ? 2 * values - std::min<std::uint64_t>(values, 1) : values * bytesOf(type);
  }

 private:
  template <class T>
  static double as(const char* raw) {
    T x;
    std::memcpy(&x, raw, sizeof x);
    return static_cast<double>(x);
  }
  std::string_view bytes_;
  Coding coding_;
  TextTokens words_;
  std::size_t at_ = 0;
};

class BodyReader {
 public:
  BodyReader(std::string_view bytes, Coding coding, Polygons& out)
      : body_(bytes, coding), coding_(coding), out_(out) {}

  Result<void> read(const Element& e) {
    const auto need = checkedProduct({e.count, e.leastBytes(coding_ == Coding::Text)});
    // The last number of a text needs no space after it.
    if (!need || *need > body_.left() + 1)
      return makeError(ErrorCode::FileDamaged, "The file declares " + std::to_string(e.count) +
                                                   " of element '" + e.name +
                                                   "', more than its bytes can hold; it is cut short.");
    const bool vertex = e.name == "vertex", face = e.name == "face";
    if (face) out_.reserve(e.count);
    for (std::uint64_t n = 0; n < e.count && !e.properties.empty(); ++n) {
      glm::dvec3 p(0);
      corners_.clear();
      for (const Property& property : e.properties)
        if (!readProperty(property, vertex, face, p)) return cutShort(e, n);
      if (vertex) out_.point(p);
      if (!face || corners_.empty()) continue;
      if (Result<void> ok = out_.polygon(corners_); !ok) {
        if (ok.error().code != ErrorCode::FileDamaged) return ok;
        return makeError(ErrorCode::FileDamaged, "Face " + std::to_string(n) + ": " + ok.error().sentence);
      }
    }
    return {};
  }

 private:
  bool readProperty(const Property& property, bool vertex, bool face, glm::dvec3& p) {
    if (!property.count) {
      const auto x = body_.next(property.type);
      if (x && vertex && property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
        p[property.name[0] - 'x'] = *x;
      return x.has_value();
    }
    const auto count = body_.index(*property.count);
    if (!count || body_.leastBytes(*count, property.type) > body_.left()) return false;
    const bool used = face && (property.name == "vertex_indices" || property.name == "vertex_index");
    for (std::uint32_t i = 0; i < *count; ++i) {
      if (!used) {
        if (!body_.next(property.type)) return false;
        continue;
      }
      const auto corner = body_.index(property.type);
      if (!corner) return false;
      corners_.push_back(*corner);
    }
    return true;
  }
  Error cutShort(const Element& e, std::uint64_t n) const {
    return makeError(ErrorCode::FileDamaged,
                     "Element '" + e.name + "' number " + std::to_string(n) + " of " +
                         std::to_string(e.count) +
                         " cannot be read: the file is cut short or holds no number there.");
  }

  Body body_;
  Coding coding_;
  Polygons& out_;
  std::vector<std::uint32_t> corners_;
};

Result<void> checkUsable(const Header& h) {
  const auto find = [&](const char* name) {
    return std::find_if(h.elements.begin(), h.elements.end(),
                        [&](const Element& e) { return e.name == name; });
  };
  const auto vertex = find("vertex"), face = find("face");
  if (find("tristrips") != h.elements.end() && face == h.elements.end())
    return makeError(ErrorCode::NotBuiltYet,
                     "The element 'tristrips' is not read; save the surface as faces.");
  if (vertex == h.elements.end() || face == h.elements.end())
    return makeError(ErrorCode::NothingToLoad,
                     "The file has no surface: the elements 'vertex' and 'face' are expected.");
  if (vertex > face)
    return makeError(ErrorCode::NotBuiltYet,
                     "Faces before vertices are not read; save the file in the usual order.");
  const auto has = [](const Element& e, std::string_view name, bool list) {
    return std::any_of(e.properties.begin(), e.properties.end(),
                       [&](const Property& p) { return p.name == name && p.count.has_value() == list; });
  };
  for (const char* axis : {"x", "y", "z"})
    if (!has(*vertex, axis, false))
      return makeError(ErrorCode::FileDamaged, "The vertices have no property '" + std::string(axis) + "'.");
  if (!has(*face, "vertex_indices", true) && !has(*face, "vertex_index", true))
    return makeError(ErrorCode::FileDamaged, "The faces have no list 'vertex_indices'.");
  return {};
}

}  // namespace

Result<void> readPly(std::string_view bytes, Polygons& out, SurfaceFile& file) {
  const Result<Header> header = HeaderReader(bytes).read();
  if (!header) return header.error();
  file.format = header->coding == Coding::Text ? "text PLY" : "binary PLY";
  if (Result<void> ok = checkUsable(*header); !ok) return ok;
  BodyReader body(bytes.substr(header->end), header->coding, out);
  for (const Element& e : header->elements)
    if (Result<void> ok = body.read(e); !ok) return ok;
  return {};
}

}  // namespace vernier::surface
