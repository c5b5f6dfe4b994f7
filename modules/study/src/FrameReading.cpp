// SPDX-License-Identifier: GPL-3.0-or-later
#include "FrameReading.h"

#include <algorithm>
#include <cmath>

#include "Luts.h"
#include "StackGeometry.h"
#include "Text.h"

namespace vernier {
namespace {

constexpr std::size_t kMaxText = 64;      // characters of LO
constexpr std::size_t kMaxMappings = 16;  // of one frame

template <std::size_t N>
std::optional<std::array<double, N>> exactly(const std::vector<double>& v) {
  if (v.size() != N) return std::nullopt;
  std::array<double, N> out;
  std::copy(v.begin(), v.end(), out.begin());
  return out;
}

}  // namespace

std::string shortCode(const AttributeReader& r, Tag t) { return r.code(t).substr(0, kMaxText); }

std::string shortText(AttributeReader& r, Tag t) {
  std::string s = r.text(t);
  if (s.size() <= kMaxText) return s;
  std::size_t end = kMaxText;
  while (end > 0 && (static_cast<unsigned char>(s[end]) & 0xC0) == 0x80) --end;  // whole UTF-8 characters
  return s.substr(0, end);
}

Position positionOf(const std::vector<double>& v) { return exactly<3>(v); }
Orientation orientationOf(const std::vector<double>& v) { return exactly<6>(v); }

void setPlane(const Position& p, const Orientation& o, FrameAttributes& a, FrameKeys& k) {
  a.plane.reset();
  a.filePlane.reset();
  k.rawPlane.reset();
  if (!p || !o) return;
  RawPlane plane;
  plane.position = {(*p)[0], (*p)[1], (*p)[2]};
  plane.row = {(*o)[0], (*o)[1], (*o)[2]};
  plane.column = {(*o)[3], (*o)[4], (*o)[5]};
  plane.offOrthonormal =
      std::max({std::abs(glm::length(plane.row) - 1), std::abs(glm::length(plane.column) - 1),
                std::abs(glm::dot(plane.row, plane.column))});
  k.rawPlane = plane;
  // 1e-9: what decimal text of the limit itself may be off.
  if (plane.offOrthonormal <= kOrthonormalFlagged + 1e-9)
    a.plane = orthonormalPlane(plane.position, plane.row, plane.column);
  if (a.plane)
    a.filePlane = FramePlane{PatientPoint(plane.position), PatientVec(plane.row), PatientVec(plane.column)};
}

bool readSpacing(const AttributeReader& r, FrameAttributes& a) {
  const auto s = r.decimals(0x00280030);
  if (s.empty()) return true;
  const auto usable = [](double v) { return v >= kMinSpacing_mm && v <= kMaxSpacing_mm; };  // false for NaN
  if (s.size() != 2 || !usable(s[0]) || !usable(s[1])) return false;
  a.pixelSpacing_mm = {s[0], s[1]};
  return true;
}

void setRescale(double slope, double intercept, FrameAttributes& a) {
  a.rescale = {slope, intercept};
  a.rescaleInvalid = !std::isfinite(slope) || !std::isfinite(intercept) || slope == 0;
  if (a.rescaleInvalid) a.rescale = {};
}

void readRescale(const AttributeReader& r, FrameAttributes& a, FrameKeys& k) {
  const auto slope = r.decimals(0x00281053), intercept = r.decimals(0x00281052);
  setRescale(slope.empty() ? 1 : slope[0], intercept.empty() ? 0 : intercept[0], a);
  k.rescaleType = shortCode(r, 0x00281054);
}

WindowList readWindows(AttributeReader& r) {
  WindowList out;
  const auto centers = r.decimals(0x00281050), widths = r.decimals(0x00281051);
  const auto explanations = splitValues(r.text(0x00281055));
  const std::string function = r.code(0x00281056);
  for (std::size_t i = 0; i < std::min(centers.size(), widths.size()); ++i) {
    VoiWindow w{centers[i], widths[i], VoiFunction::Linear, i < explanations.size() ? explanations[i] : ""};
    if (function == "LINEAR_EXACT") w.function = VoiFunction::LinearExact;
    if (function == "SIGMOID") w.function = VoiFunction::Sigmoid;
    out.centers.push_back(w.center);
    out.widths.push_back(w.width);
    if (std::isfinite(w.center) && std::isfinite(w.width) && w.width > 0) {
      out.valid.push_back(w);
    } else {
      out.badCenters.push_back(w.center);
      out.badWidths.push_back(w.width);
    }
  }
  return out;
}

std::optional<LutTable> readLut(AttributeReader& item, bool signedInput) {
  std::optional<LutTable> lut = lutFrom(item.header(), item.elements(), signedInput);
  if (lut) lut->explanation = item.text(0x00283003);
  return lut;
}

std::shared_ptr<const std::vector<RealWorldMapping>> readRealWorld(const AttributeReader& r,
                                                                   bool signedPixels) {
  std::vector<RealWorldMapping> out;
  for (AttributeReader& item : r.items(0x00409096)) {
    if (out.size() == kMaxMappings) break;
    RealWorldMapping m;
    const auto bound = [&](Tag asDouble, Tag asWord) -> std::optional<double> {
      if (const auto d = item.doubles(asDouble); !d.empty()) return d[0];
      const Element* e = item.element(asWord);
      const auto w = item.words(asWord);
      if (w.empty()) return std::nullopt;
      const bool isSigned = e->is("SS") || (!e->is("US") && signedPixels);
      return isSigned ? static_cast<double>(static_cast<std::int16_t>(w[0])) : static_cast<double>(w[0]);
    };
    const auto first = bound(0x00409214, 0x00409216), last = bound(0x00409213, 0x00409211);
    if (!first || !last || !(*first <= *last)) continue;
    m.first = *first;
    m.last = *last;
    const auto slope = item.doubles(0x00409225), intercept = item.doubles(0x00409224);
    m.table = item.doubles(0x00409212);
    if (m.table.empty()) {
      if (slope.empty() || intercept.empty() || !std::isfinite(slope[0]) || !std::isfinite(intercept[0]))
        continue;
      m.slope = slope[0];
      m.intercept = intercept[0];
    } else if (static_cast<double>(m.table.size()) != m.last - m.first + 1) {
      continue;
    }
    m.label = shortText(item, 0x00409210);
    if (auto unit = item.item(0x004008EA)) {
      m.unit = shortCode(*unit, 0x00080100);
      m.meaning = shortText(*unit, 0x00080104);
    }
    out.push_back(std::move(m));
  }
  if (out.empty()) return nullptr;
  return std::make_shared<const std::vector<RealWorldMapping>>(std::move(out));
}

void readClassicKeys(AttributeReader& r, FrameAttributes& a, FrameKeys& k) {
  k.kernel = shortCode(r, 0x00181210);
  k.kvp = shortCode(r, 0x00180060);
  k.echoNumbers = shortCode(r, 0x00180086);
  a.echoTime_ms = r.decimal(0x00180081);
  k.units = shortCode(r, 0x00541001);
  if (const auto b = r.doubles(0x00189087); !b.empty()) k.bValue_s_mm2 = b[0];
  if (const auto d = r.doubles(0x00189089); d.size() == 3)
    k.diffusionDirection = glm::dvec3(d[0], d[1], d[2]);
  a.temporalPosition = r.integer(0x00200100);
  k.acquisitionNumber = shortCode(r, 0x00200012);
  k.contrastAgent = shortText(r, 0x00180010);
  k.triggerTime = shortCode(r, 0x00181060);
  k.cardiacPhase = shortCode(r, 0x00189241);
  k.acquisitionTime = shortCode(r, 0x00080032);
  k.contentTime = shortCode(r, 0x00080033);
}

std::string unitOf(const Instance& i, const FrameAttributes& a, const FrameKeys& k,
                   const std::optional<std::string>& lutType) {
  if (a.rescaleInvalid) return "stored value";
  const bool localizer = a.imageType.size() > 2 && a.imageType[2] == "LOCALIZER";
  const std::string& type = lutType ? *lutType : k.rescaleType;
  if (i.modality == "CT" && (type == "HU" || type.empty()) && !localizer) return "HU";
  if (i.modality == "PT" && !k.units.empty()) return k.units;
  if (!type.empty() && type != "US" && type != "HU") return type;
  // A mapping that says the same numbers as the rescale gives them their unit; another one stands beside
  // them.
  if (a.realWorld && !lutType)
    for (const RealWorldMapping& m : *a.realWorld)
      if (m.table.empty() && m.slope == a.rescale.slope && m.intercept == a.rescale.intercept &&
          !m.unit.empty())
        return m.unit;
  return "stored value";
}

}  // namespace vernier
