// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/Nrrd.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "files/Affine.h"
#include "files/Channels.h"
#include "files/NrrdWords.h"
#include "files/TextParts.h"
#include "vernier/base/Checked.h"

namespace vernier {
namespace {

Error damaged(const std::string& sentence) {
  return makeError(ErrorCode::FileDamaged, "The NRRD header cannot be used: " + sentence);
}
Error notRead(const std::string& sentence) { return makeError(ErrorCode::NotBuiltYet, sentence); }

class Header {
 public:
  Header(const FileRecord& file, NrrdLines lines) : file_(file), lines_(std::move(lines)) {}

  Result<ParsedVolume> parse() {
    p_.place.file = file_;
    p_.facts.format = "NRRD";
    p_.facts.info.modality = "OT";
    Result<void> ok = readSizes();
    if (ok) ok = readType();
    if (ok) ok = readAxes();
    if (ok) ok = readGeometry();
    if (ok) ok = readPlace();
    if (!ok) return ok.error();
    if (const std::string* unit = find({"sample units"});
        unit && !unquoted(*unit).empty() && p_.place.channels == 1)
      p_.facts.info.unit = unquoted(*unit);
    return std::move(p_);
  }

 private:
  const std::string* find(std::initializer_list<const char*> names) const {
    for (const char* n : names)
      if (const auto it = lines_.fields.find(n); it != lines_.fields.end()) return &it->second;
    return nullptr;
  }
  static std::string unquoted(std::string_view s) {
    if (s.size() >= 2 && s.front() == '"' && s.back() == '"') s = s.substr(1, s.size() - 2);
    return std::string(s);
  }

  Result<void> readSizes() {
    const std::string* dimension = find({"dimension"});
    const std::string* sizes = find({"sizes"});
    if (!dimension || !sizes) return damaged("dimension or sizes is missing.");
    const auto n = numberIn<int>(*dimension);
    const auto list = numbersIn<std::int64_t>(*sizes);
    if (!n || *n < 1 || *n > 16 || !list || list->size() != static_cast<std::size_t>(*n))
      return damaged("sizes does not hold as many numbers as dimension says.");
    sizes_ = *list;
    for (const std::int64_t s : sizes_)
      if (s < 1) return damaged("a size is below 1.");
    return {};
  }

  Result<void> readType() {
    const std::string* name = find({"type"});
    if (!name) return damaged("type is missing.");
    const auto type = nrrdType(lowerCase(*name));
    if (!type) return notRead("This NRRD type is not read; convert the file to integers or floats.");
    p_.place.type = *type;
    p_.facts.storedType = nameOf(*type);
    p_.facts.info.type = voxelTypeOf(*type);
    return {};
  }

  // Which axes lie in space. One that does not may be of one entry anywhere; of colours, the fastest or the
  // slowest; or the slowest otherwise: a list of volumes.
  Result<void> readAxes() {
    std::vector<bool> spatial(sizes_.size(), true);
    if (const std::string* kinds = find({"kinds"})) {
      const auto list = words(*kinds);
      if (list.size() != sizes_.size()) return damaged("kinds does not name every axis.");
      for (std::size_t a = 0; a < list.size(); ++a) {
        const std::string k = lowerCase(list[a]);
        kinds_.push_back(k);
        spatial[a] = k == "domain" || k == "space" || k == "???" || k == "none";
      }
    }
    if (const std::string* directions = find({"space directions"})) {
      if (auto r = readDirections(*directions); !r) return r;
      for (std::size_t a = 0; a < sizes_.size(); ++a) {
        spatial[a] = directions_[a].has_value();
        if (spatial[a] && isColours(a)) return damaged("an axis of colours has a direction in space.");
      }
    } else if (sizes_.size() > 3 && std::count(spatial.begin(), spatial.end(), true) ==
                                        static_cast<std::ptrdiff_t>(sizes_.size())) {
      for (std::size_t a = 3; a < sizes_.size(); ++a)
        spatial[a] = false;  // nothing is said: the fastest three
    }
    for (std::size_t a = 0; a < sizes_.size(); ++a) {
      if (spatial[a]) {
        axes_.push_back(a);
        continue;
      }
      if (isColours(a)) {
        if (auto r = readColours(a); !r) return r;
        continue;
      }
      if (sizes_[a] == 1) continue;
      if (a + 1 < sizes_.size() || p_.facts.frames > 1)
        return notRead(
            "The NRRD file has " + std::to_string(sizes_[a]) +
            " values per voxel on an axis that is of no kind of colour; one value per voxel, or an "
            "axis of kind RGB-color or RGBA-color, is read.");
      p_.facts.frames = sizes_[a];
    }
    if (axes_.empty() || axes_.size() > 3)
      return notRead("The NRRD file has " + std::to_string(axes_.size()) +
                     " axes in space; one to three are read.");
    GridGeometry& g = p_.facts.info.grid;
    g.columns = sizes_[axes_[0]];
    g.rows = axes_.size() > 1 ? sizes_[axes_[1]] : 1;
    g.slices = axes_.size() > 2 ? sizes_[axes_[2]] : 1;
    return {};
  }

  // A vector behind the axes in space is a list of volumes, as diffusion series are written.
  bool isColours(std::size_t axis) const {
    return !kinds_.empty() && nrrdValuesPerVoxel(kinds_[axis]) &&
           (axis == 0 || !kinds_[axis].ends_with("vector"));
  }

  Result<void> readColours(std::size_t axis) {
    const std::int64_t n = sizes_[axis], named = *nrrdValuesPerVoxel(kinds_[axis]);
    if (named != 0 && named != n)
      return damaged("an axis of " + std::to_string(n) + " entries is of a kind that has " +
                     std::to_string(named) + ".");
    p_.place.planar = axis > 0;
    if (p_.place.channels > 1 || (p_.place.planar && axis + 1 < sizes_.size()))
      return notRead(
          "The colours of the NRRD file stand on an axis between others; they are read where they "
          "are the first or the last axis.");
    if (kinds_[axis].ends_with("vector") && n > 1)
      p_.facts.info.findings.push_back(
          {"colours-assumed",
           Severity::Notice,
           "The file calls the values of a voxel a vector; they are shown as red, green and blue" +
               std::string(n == 4 ? " and opacity." : "."),
           {}});
    return setChannels(p_, n);
  }

  // "(1,0,0) none (0,1,0)": one vector or "none" per axis.
  Result<void> readDirections(std::string_view s) {
    for (s = trimmed(s); !s.empty(); s = trimmed(s)) {
      if (s.starts_with("none")) {
        directions_.push_back(std::nullopt);
        s.remove_prefix(4);
        continue;
      }
      const std::size_t close = s.find(')');
      const auto v = s.front() == '(' && close != std::string_view::npos ? vectorIn(s.substr(1, close - 1))
                                                                         : std::nullopt;
      if (!v) return damaged("space directions is not one vector (or none) per axis.");
      directions_.push_back(v);
      s.remove_prefix(close + 1);
    }
    if (directions_.size() != sizes_.size()) return damaged("space directions does not name every axis.");
    return {};
  }

  // Vectors of fewer than three numbers lie in the first axes.
  static std::optional<glm::dvec3> vectorIn(std::string_view s) {
    std::string list(s);
    std::replace(list.begin(), list.end(), ',', ' ');
    const auto x = numbersIn<double>(list);
    if (!x || x->empty() || x->size() > 3) return std::nullopt;
    glm::dvec3 v(0);
    for (std::size_t i = 0; i < x->size(); ++i) v[static_cast<glm::length_t>(i)] = (*x)[i];
    return v;
  }

  // The signs that take the file's world axes to LPS; nullopt when the space is none of a patient.
  std::optional<glm::dvec3> toLps() const {
    static const std::map<std::string_view, glm::dvec3> kSpaces{
        {"left-posterior-superior", {1, 1, 1}},        {"lps", {1, 1, 1}},
        {"left-posterior-superior-time", {1, 1, 1}},   {"lpst", {1, 1, 1}},
        {"right-anterior-superior", {-1, -1, 1}},      {"ras", {-1, -1, 1}},
        {"right-anterior-superior-time", {-1, -1, 1}}, {"rast", {-1, -1, 1}},
        {"left-anterior-superior", {1, -1, 1}},        {"las", {1, -1, 1}},
        {"left-anterior-superior-time", {1, -1, 1}},   {"last", {1, -1, 1}}};
    const std::string* space = find({"space"});
    if (!space) return std::nullopt;
    const auto it = kSpaces.find(lowerCase(*space));
    return it == kSpaces.end() ? std::nullopt : std::optional(it->second);
  }

  // mm of one unit of length; unknown units are no lengths.
  Result<glm::dvec3> mmPerUnit() {
    const std::string* units = find({"space units"});
    if (!units) return glm::dvec3(1);
    static const std::map<std::string_view, double> kUnits{
        {"mm", 1},     {"millimeter", 1}, {"millimeters", 1}, {"cm", 10},        {"m", 1000},
        {"um", 0.001}, {"micron", 0.001}, {"microns", 0.001}, {"\u00b5m", 0.001}};
    glm::dvec3 mm(1);
    glm::length_t a = 0;
    for (const std::string_view w : words(*units)) {
      const auto it = kUnits.find(unquoted(w));
      if (a > 2) break;
      if (it == kUnits.end())
        return damaged("space units names a unit of length that is not known (mm, cm, m, um are).");
      mm[a++] = it->second;
    }
    return mm;
  }

  Result<void> readGeometry() {
    std::vector<Finding>& findings = p_.facts.info.findings;
    const auto mm = mmPerUnit();
    if (!mm) return mm.error();
    PatientFromVoxel& m = p_.facts.info.grid.patientFromVoxel;
    m.linear = glm::dmat3(0);
    const auto signs = toLps();
    if (!directions_.empty()) {
      for (std::size_t a = 0; a < axes_.size(); ++a)
        m.linear[static_cast<glm::length_t>(a)] = *directions_[axes_[a]] * *mm;
    } else if (auto r = readSpacings(m.linear); !r) {
      return r;
    }
    if (const std::string* origin = find({"space origin"})) {
      const auto o = origin->size() > 2 && origin->front() == '(' && origin->back() == ')'
                         ? vectorIn(std::string_view(*origin).substr(1, origin->size() - 2))
                         : std::nullopt;
      if (!o) return damaged("space origin is no vector.");
      m.translation = *o * *mm;
    }
    if (signs && !directions_.empty()) {
      for (int a = 0; a < 3; ++a) m.linear[a] *= *signs;
      m.translation *= *signs;
    } else {
      findings.push_back(
          axesUnknown("The file names no space of a patient (LPS, RAS or LAS) with directions."));
    }
    return settleAxes(p_.facts.info.grid);
  }

  Result<void> readSpacings(glm::dmat3& linear) {
    const std::string* spacings = find({"spacings"});
    std::vector<double> s(sizes_.size(), 1.0);
    if (spacings) {
      const auto list = numbersIn<double>(*spacings);
      if (!list || list->size() != sizes_.size())
        return damaged("spacings does not hold one number per axis.");
      s = *list;
    } else {
      p_.facts.info.findings.push_back(
          {"spacing-assumed",
           Severity::Warning,
           "The file states no distance between voxels; 1 mm is taken and lengths mean "
           "nothing.",
           {}});
    }
    for (std::size_t a = 0; a < axes_.size(); ++a)
      linear[static_cast<glm::length_t>(a)][static_cast<glm::length_t>(a)] = std::abs(s[axes_[a]]);
    return {};
  }

  Result<void> readPlace() {
    if (auto r = readEncoding(); !r) return r;
    const std::string* endian = find({"endian"});
    if (!endian && bytesOf(p_.place.type) > 1 && p_.place.packing != Packing::Text)
      return damaged("endian is missing.");
    if (endian) {
      const std::string e = lowerCase(*endian);
      if (e != "little" && e != "big") return damaged("endian is neither little nor big.");
      p_.place.bigEndian = e == "big";
    }
    if (p_.place.packing == Packing::Text) p_.place.bigEndian = std::endian::native == std::endian::big;
    if (auto r = readFile(); !r) return r;
    return readSkips();
  }

  Result<void> readEncoding() {
    static const std::map<std::string_view, Packing> kEncodings{
        {"raw", Packing::Raw},     {"gz", Packing::Gzip},  {"gzip", Packing::Gzip}, {"bz2", Packing::Bzip2},
        {"bzip2", Packing::Bzip2}, {"txt", Packing::Text}, {"text", Packing::Text}, {"ascii", Packing::Text}};
    const std::string* name = find({"encoding"});
    if (!name) return damaged("encoding is missing.");
    const auto it = kEncodings.find(lowerCase(*name));
    if (it == kEncodings.end())
      return notRead("This NRRD encoding is not read; raw, gzip, bzip2 and ascii are.");
    p_.place.packing = it->second;
    return {};
  }

  Result<void> readFile() {
    const std::string* data = find({"data file", "datafile"});
    if (!data) {
      if (!lines_.closed) return damaged("there is no blank line behind the header, so no voxels.");
      p_.place.offset = lines_.end;
      return {};
    }
    if (data->starts_with("LIST") || data->find('%') != std::string::npos)
      return notRead(
          "NRRD files whose voxels stand in several files are not read; save the volume in one file.");
    auto beside = besideFile(file_, *data);
    if (!beside) return beside.error();
    p_.place.file = std::move(*beside);
    return {};
  }

  Result<void> readSkips() {
    const auto skip = [&](std::initializer_list<const char*> names,
                          std::int64_t least) -> Result<std::int64_t> {
      const std::string* text = find(names);
      if (!text) return std::int64_t{0};
      const auto n = numberIn<std::int64_t>(*text);
      if (!n || *n < least) return damaged("line skip or byte skip is no number that can be used.");
      return *n;
    };
    const auto lines = skip({"line skip", "lineskip"}, 0);
    const auto bytes = skip({"byte skip", "byteskip"}, -1);
    if (!lines) return lines.error();
    if (!bytes) return bytes.error();
    p_.place.skipLines = static_cast<std::uint64_t>(*lines);
    if (*bytes == -1 && p_.place.packing != Packing::Raw)
      return damaged("byte skip is -1, which is defined for raw data only.");
    p_.place.atEnd = *bytes == -1;
    // In packed data bytes are counted once they are unpacked.
    if (*bytes > 0) p_.place.skip = static_cast<std::uint64_t>(*bytes);
    return {};
  }

  const FileRecord& file_;
  NrrdLines lines_;
  ParsedVolume p_;
  std::vector<std::int64_t> sizes_;
  std::vector<std::string> kinds_;                     // lower case; empty when the header has none
  std::vector<std::optional<glm::dvec3>> directions_;  // per axis, empty when the header has none
  std::vector<std::size_t> axes_;                      // those in space, fastest first
};

}  // namespace

bool looksLikeNrrd(std::string_view text) {
  return text.size() >= 9 && text.starts_with("NRRD000") && text[7] >= '1' && text[7] <= '9' &&
         (text[8] == '\n' || text[8] == '\r');
}

Result<ParsedVolume> parseNrrd(const FileRecord& file, std::string_view text) {
  if (text[7] > '6') return notRead("This NRRD file is of a version that is not read (1 to 6 are).");
  auto lines = splitNrrdLines(text);
  if (!lines) return lines.error();
  return Header(file, std::move(*lines)).parse();
}

}  // namespace vernier
