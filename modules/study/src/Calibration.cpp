// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/study/Calibration.h"

#include <cmath>
#include <string_view>

#include "AttributeReader.h"
#include "ByteSource.h"
#include "StackGeometry.h"

namespace vernier {
namespace {

constexpr std::string_view kSecondaryCapture =
    "1.2.840.10008.5.1.4.1.1.7";  // and its multi-frame kinds .7.1 to .7.4
constexpr std::size_t kMostRegions = 64;

std::optional<glm::dvec2> pairOf(const std::vector<double>& v) {
  const auto usable = [](double x) { return x > 0 && std::isfinite(x); };
  if (v.size() != 2 || !usable(v[0]) || !usable(v[1])) return std::nullopt;
  return glm::dvec2(v[0], v[1]);
}

std::optional<glm::dvec2> spacingOf(const AttributeReader& r, Tag t) {
  const auto s = pairOf(r.decimals(t));
  const auto usable = [](double x) { return x >= kMinSpacing_mm && x <= kMaxSpacing_mm; };
  return s && usable(s->x) && usable(s->y) ? s : std::nullopt;
}

std::optional<UltrasoundRegion> regionOf(const AttributeReader& r) {
  UltrasoundRegion out;
  const auto corner = [&](Tag t, std::int64_t& into) {
    const auto v = r.longs(t);
    if (v.empty()) return false;
    into = static_cast<std::int64_t>(v[0]);
    return true;
  };
  const auto units = [&](Tag t) {
    const auto v = r.words(t);
    return v.empty() ? std::uint16_t{0} : v[0];
  };
  const auto delta = [&](Tag t) {
    const auto v = r.doubles(t);
    return v.empty() || !std::isfinite(v[0]) ? 0.0 : v[0];
  };
  if (!corner(0x00186018, out.firstColumn) || !corner(0x0018601A, out.firstRow) ||
      !corner(0x0018601C, out.lastColumn) || !corner(0x0018601E, out.lastRow))
    return std::nullopt;
  out.unitsX = units(0x00186024);
  out.unitsY = units(0x00186026);
  out.deltaX = delta(0x0018602C);
  out.deltaY = delta(0x0018602E);
  return out;
}

PixelCalibration calibrationFrom(const AttributeReader& r, const std::string& sopClassUid) {
  PixelCalibration c;
  c.imagerSpacing_mm = spacingOf(r, 0x00181164);
  c.filmSpacing_mm = spacingOf(r, 0x00182010);
  c.aspectRatio = pairOf(r.decimals(0x00280034));  // IS; what is a whole number is a decimal too
  if (const auto m = r.decimal(0x00181114); m && *m > 0 && std::isfinite(*m))
    c.radiographicMagnification = *m;
  c.calibrationType = r.code(0x00280A02).substr(0, 16);
  c.secondaryCapture =
      sopClassUid == kSecondaryCapture || sopClassUid.starts_with(std::string(kSecondaryCapture) + ".");
  for (const AttributeReader& item : r.items(0x00186011)) {
    if (c.regions.size() == kMostRegions) break;
    if (const auto region = regionOf(item)) c.regions.push_back(*region);
  }
  return c;
}

}  // namespace

Result<PixelCalibration> pixelCalibration(const StudySet& set, std::size_t instance) {
  const Instance& i = set.instances.at(instance);
  const auto source = openSource(set.files.at(i.file));
  if (!source) return source.error();
  const Result<Header> header = readHeader(**source);
  if (!header) return header.error();
  return calibrationFrom(AttributeReader(*header), i.sopClassUid);
}

}  // namespace vernier
