// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/Sidecar.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "files/Affine.h"
#include "files/Channels.h"

namespace vernier {
namespace {
using Json = nlohmann::json;

constexpr std::string_view kSchema = "vernier-raw/1";

class Reader {
 public:
  Reader(const FileRecord& file, Json json) : file_(file), j_(std::move(json)) {}

  Result<ParsedVolume> parse() {
    static const std::set<std::string> kKeys{
        "format",     "data",         "encoding",  "dims",    "type",    "byte_order",
        "spacing_mm", "origin_mm",    "direction", "axes",    "unit",    "slope",
        "intercept",  "header_bytes", "modality",  "no_data", "channels"};
    for (const auto& [key, value] : j_.items())
      if (!kKeys.contains(key)) return bad(key, "is not a key of " + std::string(kSchema));
    p_.facts.format = "raw";
    Result<void> ok = readValues();
    if (ok) ok = readGeometry();
    if (ok) ok = readPlace();
    if (!ok) return ok.error();
    return std::move(p_);
  }

 private:
  Error bad(const std::string& key, const std::string& what) const {
    return makeError(ErrorCode::FileDamaged, "/" + key + " " + what + " (docs/files.md has the keys).",
                     file_.shown);
  }
  // Finite numbers; `out` keeps its value when the key is absent.
  template <class T>
  Result<void> numbers(const char* key, std::vector<T>& out) const {
    if (!j_.contains(key)) return {};
    const Json& a = j_.at(key);
    const Error wrong = bad(key, "must be a list of " + std::to_string(out.size()) + " numbers");
    if (!a.is_array() || a.size() != out.size()) return wrong;
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (std::is_integral_v<T> ? !a[i].is_number_integer() : !a[i].is_number()) return wrong;
      out[i] = a[i].template get<T>();
    }
    return {};
  }
  template <class T>
  Result<void> number(const char* key, T& out) const {
    if (!j_.contains(key)) return {};
    const Json& a = j_.at(key);
    if (std::is_integral_v<T> ? !a.is_number_integer() : !a.is_number()) return bad(key, "must be a number");
    out = a.get<T>();
    return {};
  }
  Result<std::string> text(const char* key, const std::string& otherwise) const {
    if (!j_.contains(key)) return otherwise;
    if (!j_.at(key).is_string()) return bad(key, "must be a text");
    return j_.at(key).get<std::string>();
  }

  Result<void> readValues() {
    static const std::map<std::string, FileType> kTypes{
        {"uint8", FileType::U8},   {"int8", FileType::I8},    {"uint16", FileType::U16},
        {"int16", FileType::I16},  {"uint32", FileType::U32}, {"int32", FileType::I32},
        {"uint64", FileType::U64}, {"int64", FileType::I64},  {"float32", FileType::F32},
        {"float64", FileType::F64}};
    VolumeInfo& info = p_.facts.info;
    const auto type = text("type", ""), order = text("byte_order", ""), unit = text("unit", info.unit),
               modality = text("modality", "OT");
    for (const auto* t : {&type, &order, &unit, &modality})
      if (!*t) return t->error();
    const auto it = kTypes.find(*type);
    if (it == kTypes.end())
      return bad("type", "must be one of uint8 to uint64, int8 to int64, float32, float64");
    p_.place.type = it->second;
    p_.facts.storedType = *type;
    info.type = voxelTypeOf(it->second);
    const bool stated = *order == "little" || *order == "big";
    if (!stated && (!order->empty() || bytesOf(it->second) > 1))
      return bad("byte_order", "must be little or big");
    p_.place.bigEndian = *order == "big";
    info.unit = unit->empty() ? info.unit : *unit;
    info.modality = *modality;
    if (auto ok = readChannels(); !ok) return ok;
    ModalityRescale& r = info.rescale[0];
    if (auto ok = number("slope", r.slope); !ok) return ok;
    if (auto ok = number("intercept", r.intercept); !ok) return ok;
    if (!std::isfinite(r.slope) || r.slope == 0 || !std::isfinite(r.intercept))
      return makeError(ErrorCode::RescaleInvalid, "/slope must not be 0, and both it and /intercept finite.",
                       file_.shown);
    return readNoData();
  }

  Result<void> readChannels() {
    std::int64_t channels = 1;
    if (auto ok = number("channels", channels); !ok) return ok;
    if (channels < 1) return bad("channels", "must be 1, 3 or 4");
    if (channels > 1)
      for (const char* grey : {"unit", "slope", "intercept", "no_data"})
        if (j_.contains(grey)) return bad(grey, "is for one value per voxel; colours have none");
    return setChannels(p_, channels);
  }

  Result<void> readNoData() {
    if (!j_.contains("no_data")) return {};
    std::vector<double> range(2);
    if (j_.at("no_data").is_number()) {
      range[0] = range[1] = j_.at("no_data").get<double>();
    } else if (auto ok = numbers("no_data", range); !ok) {
      return ok;
    }
    if (!(range[0] <= range[1])) return bad("no_data", "must be a value or a range that ascends");
    p_.facts.info.noData = NoDataRange{range[0], range[1]};
    return {};
  }

  Result<void> readGeometry() {
    if (!j_.contains("dims")) return bad("dims", "is missing");
    if (!j_.contains("spacing_mm")) return bad("spacing_mm", "is missing");
    std::vector<std::int64_t> dims(3);
    std::vector<double> spacing(3), origin(3), direction{1, 0, 0, 0, 1, 0, 0, 0, 1};
    Result<void> ok = numbers("dims", dims);
    if (ok) ok = numbers("spacing_mm", spacing);
    if (ok) ok = numbers("origin_mm", origin);
    if (ok) ok = numbers("direction", direction);
    const auto axes = text("axes", "unknown");
    if (ok && !axes) ok = axes.error();
    if (!ok) return ok;
    for (const std::int64_t n : dims)
      if (n < 1) return bad("dims", "must be above 0");
    for (const double s : spacing)
      if (!(s > 0)) return bad("spacing_mm", "must be above 0");
    GridGeometry& g = p_.facts.info.grid;
    g.columns = dims[0], g.rows = dims[1], g.slices = dims[2];
    for (std::size_t a = 0; a < 3; ++a)
      g.patientFromVoxel.linear[static_cast<glm::length_t>(a)] =
          spacing[a] * glm::dvec3(direction[3 * a], direction[3 * a + 1], direction[3 * a + 2]);
    g.patientFromVoxel.translation = {origin[0], origin[1], origin[2]};
    if (*axes == "RAS")
      g.patientFromVoxel = lpsFromRas(g.patientFromVoxel);
    else if (*axes == "unknown")
      p_.facts.info.findings.push_back(
          axesUnknown("The file beside the voxels states no axes (LPS or RAS)."));
    else if (*axes != "LPS")
      return bad("axes", "must be LPS, RAS or unknown");
    return settleAxes(g);
  }

  Result<void> readPlace() {
    static const std::map<std::string, Packing> kEncodings{
        {"raw", Packing::Raw}, {"gzip", Packing::Gzip}, {"bzip2", Packing::Bzip2}};
    const auto data = text("data", nameWithout(".json"));
    const auto encoding = text("encoding", "raw");
    if (!data) return data.error();
    if (!encoding) return encoding.error();
    const auto it = kEncodings.find(*encoding);
    if (it == kEncodings.end()) return bad("encoding", "must be raw, gzip or bzip2");
    if (data->empty()) return bad("data", "is missing");
    auto beside = besideFile(file_, *data);
    if (!beside) return beside.error();
    p_.place.file = std::move(*beside);
    p_.place.packing = it->second;
    std::int64_t skip = 0;
    if (auto ok = number("header_bytes", skip); !ok) return ok;
    if (skip < -1 || (skip == -1 && it->second != Packing::Raw))
      return bad("header_bytes", "must be 0 or more, or -1 for raw data at the file's end");
    p_.place.atEnd = skip == -1;
    if (skip > 0) p_.place.skip = static_cast<std::uint64_t>(skip);
    return {};
  }

  // "head.raw.json" -> "head.raw"; "" when the name ends otherwise.
  std::string nameWithout(std::string_view ending) const {
    std::string name = file_.shown.substr(file_.shown.rfind('/') + 1);
    if (!name.ends_with(ending) || name.size() == ending.size()) return "";
    name.resize(name.size() - ending.size());
    return name.find('.') == std::string::npos ? "" : name;
  }

  const FileRecord& file_;
  Json j_;
  ParsedVolume p_;
};

bool isVtkJs(std::string_view text) {
  return text.find("\"vtkClass\"") != std::string_view::npos &&
         text.find("\"vtkImageData\"") != std::string_view::npos;
}

}  // namespace

bool looksLikeSidecar(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || text[first] != '{') return false;
  return text.find("\"vernier-raw/") != std::string_view::npos || isVtkJs(text);
}

Result<ParsedVolume> parseSidecar(const FileRecord& file, std::string_view text) {
  if (text.size() >= kMaxSidecarBytes)
    return makeError(ErrorCode::LimitExceeded,
                     "The JSON file is longer than 64 KiB, which no description of voxels is.");
  Json j = Json::parse(text, nullptr, false);
  if (j.is_discarded() || !j.is_object())
    return makeError(ErrorCode::FileDamaged, "The file beside the voxels is not JSON that can be read.",
                     file.shown);
  const auto format = j.find("format");
  if (format != j.end() && *format == kSchema) return Reader(file, std::move(j)).parse();
  if (isVtkJs(text))
    return makeError(
        ErrorCode::NotBuiltYet,
        "This is a data set of vtk.js, which is not read; its voxels are a raw file that a JSON file of "
        "schema vernier-raw/1 can describe (docs/files.md).");
  return makeError(ErrorCode::NotBuiltYet, "Only schema vernier-raw/1 of such JSON files is read.",
                   file.shown);
}

}  // namespace vernier
