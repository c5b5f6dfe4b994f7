// SPDX-License-Identifier: GPL-3.0-or-later
#include "MetaHeader.h"

#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

namespace vernier {
namespace {

using Fields = std::map<std::string, std::string, std::less<>>;

std::string_view trimmed(std::string_view s) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!s.empty() && blank(s.front())) s.remove_prefix(1);
  while (!s.empty() && blank(s.back())) s.remove_suffix(1);
  return s;
}

bool printable(std::string_view s) {
  for (char c : s)
    if (static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\r') return false;
  return true;
}

// "Key = value" lines up to ElementDataFile, which is the last by definition. End: offset after that line.
struct Lines {
  Fields fields;
  std::size_t end = 0;
};
std::optional<Lines> splitLines(std::string_view text) {
  Lines out;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t eol = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, eol - at);
    at = std::min(eol + 1, text.size());
    if (trimmed(line).empty()) continue;
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos || !printable(line)) return std::nullopt;
    const std::string key(trimmed(line.substr(0, equals)));
    out.fields[key] = std::string(trimmed(line.substr(equals + 1)));
    if (key == "ElementDataFile") {
      out.end = at;
      return out;
    }
  }
  return std::nullopt;
}

template <class T>
std::optional<std::vector<T>> numbers(std::string_view s) {
  std::vector<T> out;
  for (s = trimmed(s); !s.empty(); s = trimmed(s)) {
    if (s.front() == '+') s.remove_prefix(1);
    T x{};
    const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), x);
    if (error != std::errc() || (end != s.data() + s.size() && *end != ' ' && *end != '\t'))
      return std::nullopt;
    out.push_back(x);
    s.remove_prefix(static_cast<std::size_t>(end - s.data()));
  }
  return out;
}

class Reader {
 public:
  Reader(const Fields& f, const std::string& where) : fields_(f), where_(where) {}

  const std::string* find(std::initializer_list<const char*> keys) const {
    for (const char* k : keys)
      if (const auto it = fields_.find(k); it != fields_.end()) return &it->second;
    return nullptr;
  }
  // Fills `out` when one of the keys is there; FileDamaged when it is not `out.size()` finite numbers.
  template <class T, std::size_t N>
  Result<void> read(std::initializer_list<const char*> keys, std::array<T, N>& out, std::size_t n) const {
    const std::string* text = find(keys);
    if (!text) return {};
    const auto x = numbers<T>(*text);
    if (!x || x->size() != n)
      return damaged(std::string(*keys.begin()) + " is not " + std::to_string(n) + " numbers.");
    for (std::size_t i = 0; i < n; ++i) {
      if (!std::isfinite(static_cast<double>((*x)[i])))
        return makeError(
            ErrorCode::GeometryRefused,
            std::string(*keys.begin()) + " holds a number that is not finite; correct the header.", where_);
      out[i] = (*x)[i];
    }
    return {};
  }
  bool flag(std::initializer_list<const char*> keys) const {
    const std::string* text = find(keys);
    return text && (*text == "True" || *text == "true" || *text == "TRUE" || *text == "1");
  }
  Error damaged(const std::string& sentence) const {
    return makeError(ErrorCode::FileDamaged, "The MetaImage header cannot be read: " + sentence, where_);
  }
  Error notBuilt(const std::string& sentence) const {
    return makeError(ErrorCode::NotBuiltYet, sentence, where_);
  }

 private:
  const Fields& fields_;
  const std::string& where_;
};

std::optional<VoxelType> voxelType(std::string_view element) {
  if (element == "MET_CHAR") return VoxelType::I8;
  if (element == "MET_UCHAR") return VoxelType::U8;
  if (element == "MET_SHORT") return VoxelType::I16;
  if (element == "MET_USHORT") return VoxelType::U16;
  if (element == "MET_INT" || element == "MET_LONG")
    return VoxelType::I32;  // MET_LONG has four bytes in MetaImage
  if (element == "MET_UINT" || element == "MET_ULONG") return VoxelType::U32;
  if (element == "MET_FLOAT") return VoxelType::F32;
  return std::nullopt;
}

Result<void> readSize(const Reader& r, MetaHeader& h, std::size_t& dims) {
  std::array<std::int64_t, 1> n{3};
  Result<void> ok = r.read({"NDims"}, n, 1);
  if (!ok) return ok;
  if (n[0] != 2 && n[0] != 3)
    return r.notBuilt("Only MetaImages of 2 or 3 dimensions are read; this one has " + std::to_string(n[0]) +
                      ".");
  dims = static_cast<std::size_t>(n[0]);
  if (!r.find({"DimSize"})) return r.damaged("DimSize is missing.");
  ok = r.read({"DimSize"}, h.size, dims);
  if (!ok) return ok;
  for (std::int64_t x : h.size)
    if (x < 1) return r.damaged("DimSize must be positive.");
  return {};
}

Result<void> readGeometry(const Reader& r, MetaHeader& h, std::size_t dims) {
  Result<void> ok = r.read({"ElementSpacing", "ElementSize"}, h.spacing_mm, dims);
  if (ok) ok = r.read({"Offset", "Position", "Origin"}, h.offset_mm, dims);
  std::array<double, 9> m{};
  const bool turned = r.find({"TransformMatrix", "Rotation", "Orientation"}) != nullptr;
  if (ok && turned) ok = r.read({"TransformMatrix", "Rotation", "Orientation"}, m, dims * dims);
  if (!ok) return ok;
  if (turned)
    for (std::size_t axis = 0; axis < dims; ++axis)
      for (std::size_t i = 0; i < dims; ++i)
        h.direction[axis][static_cast<glm::length_t>(i)] = m[axis * dims + i];
  return {};
}

Result<void> checkSpacing(const MetaHeader& h, const std::string& where) {
  for (double s : h.spacing_mm)
    if (!(s >= 1e-4 && s <= 1e3))
      return makeError(ErrorCode::GeometryRefused,
                       "ElementSpacing must lie between 0.0001 and 1000 mm on each axis; correct the header.",
                       where);
  return {};
}

Result<void> readElements(const Reader& r, MetaHeader& h) {
  std::array<std::int64_t, 1> one{1};
  Result<void> ok = r.read({"ElementNumberOfChannels"}, one, 1);
  if (!ok) return ok;
  if (one[0] != 1)
    return r.notBuilt("Only MetaImages of one channel are read; this one has " + std::to_string(one[0]) +
                      ".");
  const std::string* element = r.find({"ElementType"});
  if (!element) return r.damaged("ElementType is missing.");
  const auto type = voxelType(*element);
  if (!type)
    return r.notBuilt(
        "This ElementType is not read; convert the file to a type of 8, 16 or 32 bits or to MET_FLOAT.");
  h.type = *type;
  if (const std::string* binary = r.find({"BinaryData"}); binary && !r.flag({"BinaryData"}))
    return r.notBuilt(
        "MetaImages with text data (BinaryData = False) are not read; save the file as binary.");
  h.bigEndian = r.flag({"BinaryDataByteOrderMSB", "ElementByteOrderMSB"});
  h.compressed = r.flag({"CompressedData"});
  std::array<std::int64_t, 1> skip{0};
  ok = r.read({"HeaderSize"}, skip, 1);
  if (!ok) return ok;
  if (skip[0] < -1) return r.damaged("HeaderSize is negative.");
  h.headerSize = skip[0];
  std::array<double, 1> slope{1}, intercept{0};
  ok = r.read({"ElementToIntensityFunctionSlope"}, slope, 1);
  if (ok) ok = r.read({"ElementToIntensityFunctionOffset"}, intercept, 1);
  if (!ok) return ok;
  if (slope[0] != 0) h.slope = slope[0], h.intercept = intercept[0];
  return {};
}

Result<void> readDataFile(const Reader& r, MetaHeader& h) {
  h.dataFile = *r.find({"ElementDataFile"});
  if (h.dataFile.empty()) return r.damaged("ElementDataFile is empty.");
  if (h.dataFile.starts_with("LIST") || h.dataFile.find('%') != std::string::npos)
    return r.notBuilt("MetaImages whose data is a list of files are not read; save the volume in one file.");
  if (h.dataFile == "Local" || h.dataFile == "local") h.dataFile = "LOCAL";
  return {};
}

}  // namespace

Result<MetaHeader> parseMetaHeader(std::string_view text, const std::string& where) {
  const auto lines = splitLines(text.substr(0, kMaxMetaHeaderBytes));
  if (!lines || !lines->fields.contains("DimSize"))
    return makeError(
        ErrorCode::FormatUnknown,
        "This is no MetaImage header: lines of the form 'Key = value' that end with ElementDataFile are "
        "expected.",
        where);
  const Reader r(lines->fields, where);
  if (const std::string* object = r.find({"ObjectType"}); object && *object != "Image")
    return r.notBuilt("Only MetaIO files with ObjectType = Image are read.");
  MetaHeader h;
  h.dataOffset = lines->end;
  std::size_t dims = 3;
  Result<void> ok = readSize(r, h, dims);
  if (ok) ok = readGeometry(r, h, dims);
  if (ok) ok = checkSpacing(h, where);
  if (ok) ok = readElements(r, h);
  if (ok) ok = readDataFile(r, h);
  if (!ok) return ok.error();
  if (const std::string* m = r.find({"Modality"})) {
    if (*m == "MET_MOD_CT") h.modality = "CT";
    if (*m == "MET_MOD_MR") h.modality = "MR";
  }
  return h;
}

}  // namespace vernier
