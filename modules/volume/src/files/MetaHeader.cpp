// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/MetaHeader.h"

#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "files/Affine.h"
#include "files/Channels.h"
#include "files/TextParts.h"

namespace vernier {
namespace {

using Fields = std::map<std::string, std::string, std::less<>>;

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
    const auto x = numbersIn<T>(*text);
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

std::optional<FileType> elementType(std::string_view element) {
  static const std::map<std::string_view, FileType> kTypes{
      {"MET_CHAR", FileType::I8},       {"MET_UCHAR", FileType::U8},       {"MET_SHORT", FileType::I16},
      {"MET_USHORT", FileType::U16},    {"MET_INT", FileType::I32},        {"MET_UINT", FileType::U32},
      {"MET_LONG", FileType::I32},      {"MET_ULONG", FileType::U32},  // four bytes in MetaImage
      {"MET_LONG_LONG", FileType::I64}, {"MET_ULONG_LONG", FileType::U64}, {"MET_FLOAT", FileType::F32},
      {"MET_DOUBLE", FileType::F64}};
  const auto it = kTypes.find(element);
  return it == kTypes.end() ? std::nullopt : std::optional(it->second);
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
    if (!(s > 0))
      return makeError(ErrorCode::GeometryRefused,
                       "ElementSpacing must be above 0 on each axis; correct the header.", where);
  return {};
}

Result<void> readElements(const Reader& r, MetaHeader& h) {
  std::array<std::int64_t, 1> one{1};
  Result<void> ok = r.read({"ElementNumberOfChannels"}, one, 1);
  if (!ok) return ok;
  if (one[0] < 1) return r.damaged("ElementNumberOfChannels must be positive.");
  h.channels = one[0];
  const std::string* element = r.find({"ElementType"});
  if (!element) return r.damaged("ElementType is missing.");
  const auto type = elementType(*element);
  if (!type) return r.notBuilt("This ElementType is not read; convert the file to integers or floats.");
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

namespace {

GridGeometry gridOf(const MetaHeader& h) {
  GridGeometry g;
  g.columns = h.size[0];
  g.rows = h.size[1];
  g.slices = h.size[2];
  for (int axis = 0; axis < 3; ++axis)
    g.patientFromVoxel.linear[axis] =
        h.spacing_mm[static_cast<std::size_t>(axis)] * h.direction[static_cast<std::size_t>(axis)];
  g.patientFromVoxel.translation = {h.offset_mm[0], h.offset_mm[1], h.offset_mm[2]};
  return g;
}

// Colours have no modality values that a slope could make.
void readRescale(const MetaHeader& h, VolumeInfo& info) {
  if (info.channels == 1)
    info.rescale = {{h.slope, h.intercept}};
  else if (h.slope != 1 || h.intercept != 0)
    info.findings.push_back({"rescale-not-applied",
                             Severity::Notice,
                             "The header states a slope and intercept, which colours do not have; they are "
                             "shown as stored.",
                             {{"slope", h.slope}, {"intercept", h.intercept}}});
}

}  // namespace

Result<ParsedVolume> parseMetaImage(const FileRecord& file, std::string_view text) {
  const auto h = parseMetaHeader(text, file.shown);
  if (!h) return h.error();
  ParsedVolume p;
  p.place.file = file;
  if (h->dataFile == "LOCAL") {
    p.place.offset = h->dataOffset;
  } else {
    auto data = besideFile(file, h->dataFile);
    if (!data) return data.error();
    p.place.file = std::move(*data);
  }
  p.place.packing = h->compressed ? Packing::Gzip : Packing::Raw;
  if (h->headerSize > 0) p.place.offset += static_cast<std::uint64_t>(h->headerSize);
  p.place.atEnd = h->headerSize < 0 && !h->compressed;
  p.place.type = h->type;
  p.place.bigEndian = h->bigEndian;
  p.facts.format = "MetaImage";
  p.facts.storedType = nameOf(h->type);
  p.facts.info.type = voxelTypeOf(h->type);
  p.facts.info.modality = h->modality;
  p.facts.info.grid = gridOf(*h);
  if (auto ok = setChannels(p, h->channels); !ok) return ok.error();
  readRescale(*h, p.facts.info);
  if (auto ok = settleAxes(p.facts.info.grid); !ok) return ok.error();
  return p;
}

}  // namespace vernier
