// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <set>

#include "JsonReading.h"
#include "Keys.h"
#include "vernier/base/Guarded.h"
#include "vernier/measure/MeasurementJson.h"

namespace vernier::measure {
namespace {

constexpr std::uint64_t kMostFrames = 1u << 30;
constexpr std::size_t kMostBins = 4096, kMostListed = 10'000;

std::size_t choice(const ObjectReader& o, const char* key, std::span<const char* const> words) {
  const std::string given = o.text(key);
  std::string known;
  for (std::size_t n = 0; n < words.size(); ++n) {
    if (given == words[n]) return n;
    known += (known.empty() ? "" : ", ") + std::string(words[n]);
  }
  throw JsonFault{"'" + given + "' is none of: " + known + ".", o.pathOf(key)};
}

glm::dvec3 vec(const ObjectReader& o, const char* key) {
  const std::vector<double> v = numbersAt(o.child(key), 3, o.pathOf(key));
  return {v[0], v[1], v[2]};
}

class ShapeReader {
 public:
  ShapeReader(const ObjectReader& o, Space space) : o_(o), space_(space) {}

  Shape read(const std::string& kind) const {
    if (kind == "length") return Length{exactly<2>("points")};
    if (kind == "bidirectional") return Bidirectional{exactly<2>("long"), exactly<2>("short")};
    if (kind == "angle") {
      const auto p = exactly<3>("points");
      return Angle{p[1], {p[0], p[2]}};
    }
    if (kind == "cobb") return Cobb{exactly<2>("first"), exactly<2>("second")};
    if (kind == "rectangle") return RectangleRegion{exactly<2>("points")};
    if (kind == "ellipse") return EllipseRegion{exactly<2>("points")};
    if (kind == "polygon") return PolygonRegion{spots("points")};
    if (kind == "freehand") return FreehandRegion{spots("points")};
    if (kind == "threshold") return ThresholdRegion{o_.number("level"), one("seed")};
    if (kind == "probe") return Probe{one("point")};
    if (kind == "arrow") {
      const auto p = exactly<2>("points");
      return Arrow{p[0], p[1], o_.textOr("text")};
    }
    if (kind == "text") return Text{one("point"), o_.text("text")};
    return readSolid(kind);
  }
  std::vector<Spot> spots(const char* key) const {
    const nlohmann::json& list = o_.array(key);
    if (list.size() > kMostOutlinePoints)
      throw JsonFault{"The list has " + std::to_string(list.size()) + " points, at most " +
                          std::to_string(kMostOutlinePoints) + " are read.",
                      o_.pathOf(key)};
    std::vector<Spot> out;
    for (std::size_t n = 0; n < list.size(); ++n) out.push_back(spot(list[n], pointerTo(o_.pathOf(key), n)));
    return out;
  }

 private:
  Shape readSolid(const std::string& kind) const {
    if (kind == "point_to_surface") return PointToSurface{one("point"), surface("surface")};
    if (kind == "tool_to_vessel") return ToolToVessel{surface("tool"), surface("vessel")};
    if (kind == "surface_volume") return SurfaceVolume{surface("surface")};
    if (kind == "convex_volume") return ConvexVolume{planes()};
    if (kind == "iso_volume")
      return IsoVolume{o_.number("level"), o_.has("seed") ? std::optional(one("seed")) : std::nullopt};
    throw JsonFault{"'" + kind + "' is no kind of measurement; see docs/measurements.md for those there are.",
                    o_.pathOf("kind")};
  }
  Spot spot(const nlohmann::json& v, const std::string& path) const {
    const bool flat = space_ == Space::Image;
    const std::vector<double> x = numbersAt(v, flat ? 2 : 3, path);
    return {x[0], x[1], flat ? 0 : x[2]};
  }
  Spot one(const char* key) const { return spot(o_.child(key), o_.pathOf(key)); }
  template <std::size_t N>
  std::array<Spot, N> exactly(const char* key) const {
    const std::vector<Spot> list = spots(key);
    if (list.size() != N)
      throw JsonFault{"A list of " + std::to_string(N) + " points is expected here, not of " +
                          std::to_string(list.size()) + ".",
                      o_.pathOf(key)};
    std::array<Spot, N> out;
    std::copy(list.begin(), list.end(), out.begin());
    return out;
  }
  SurfaceRef surface(const char* key) const {
    const ObjectReader o(o_.child(key), o_.pathOf(key));
    SurfaceRef s;
    if (o.has("level")) {
      s.level_val = o.number("level");
    } else {
      s.name = o.text("name");
      if (o.has("pose")) s.pose = pose(o);
    }
    o.refuseOthers();
    return s;
  }
  // Sixteen numbers, row by row, the last row 0 0 0 1.
  static PatientFromMesh pose(const ObjectReader& o) {
    const std::vector<double> m = numbersAt(o.child("pose"), 16, o.pathOf("pose"));
    if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
      throw JsonFault{"The last row of a pose is 0 0 0 1; the numbers stand row by row.", o.pathOf("pose")};
    PatientFromMesh p;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        p.linear[column][row] = m[static_cast<std::size_t>(4 * row + column)];
      p.translation[row] = m[static_cast<std::size_t>(4 * row + 3)];
    }
    return p;
  }
  std::vector<HalfSpace> planes() const {
    const nlohmann::json& list = o_.array("planes");
    if (list.size() > kMostPlanes)
      throw JsonFault{"At most " + std::to_string(kMostPlanes) + " planes are read.", o_.pathOf("planes")};
    std::vector<HalfSpace> out;
    for (std::size_t n = 0; n < list.size(); ++n) {
      const ObjectReader p(list[n], pointerTo(o_.pathOf("planes"), n));
      out.push_back({PatientVec(vec(p, "normal")), p.number("offset_mm")});
      p.refuseOthers();
    }
    return out;
  }
  const ObjectReader& o_;
  Space space_;
};

Placement readPlacement(const ObjectReader& o) {
  constexpr const char* spaces[] = {"image", "patient"};
  Placement p;
  p.space = choice(o, "space", spaces) == 0 ? Space::Image : Space::Patient;
  p.source = o.textOr("source");
  if (p.space == Space::Image && o.has("frame"))
    p.frame = static_cast<std::int64_t>(o.count("frame", kMostFrames));
  if (o.has("shown")) p.shown = static_cast<Shown>(choice(o, "shown", kShownWords));
  if (o.has("normal") || o.has("up"))
    p.axes = Placement::Axes{PatientVec(vec(o, "normal")), PatientVec(vec(o, "up"))};
  if (o.has("screen_pixel")) p.screenPixel = o.number("screen_pixel");
  if (p.screenPixel < 0) throw JsonFault{"The number cannot be below 0.", o.pathOf("screen_pixel")};
  if (o.has("user_spacing_mm")) {
    const auto s = numbersAt(o.child("user_spacing_mm"), 2, o.pathOf("user_spacing_mm"));
    if (!(s[0] > 0 && s[1] > 0)) throw JsonFault{"A spacing is above 0.", o.pathOf("user_spacing_mm")};
    p.userSpacing_mm = glm::dvec2(s[0], s[1]);
  }
  return p;
}

Quantity readQuantity(const ObjectReader& o) {
  Quantity q;
  q.name = o.text("name");
  q.value = o.number("value");
  q.unit = o.text("unit");
  if (o.has("expanded")) q.expanded = o.number("expanded");
  if (o.has("text")) o.text("text");  // made anew from the numbers
  o.refuseOthers();
  return q;
}

Statistics readStatistics(const ObjectReader& o) {
  constexpr auto most = std::numeric_limits<std::uint64_t>::max();
  Statistics s;
  s.n = o.count("n", most);
  s.noData = o.count("no_data", most);
  s.min = o.number("min");
  s.max = o.number("max");
  s.mean = o.number("mean");
  s.median = o.number("median");
  if (o.has("sd")) s.sd = o.number("sd");
  s.effective = o.number("effective_n");
  const ObjectReader h(o.child("histogram"), o.pathOf("histogram"));
  s.histogram.first = h.number("first");
  s.histogram.width = h.number("width");
  const nlohmann::json& counts = h.array("counts");
  if (counts.size() > kMostBins) throw JsonFault{"The histogram has too many bins.", h.pathOf("counts")};
  for (std::size_t n = 0; n < counts.size(); ++n) {
    if (!counts[n].is_number_unsigned())
      throw JsonFault{"A count is expected here.", pointerTo(h.pathOf("counts"), n)};
    s.histogram.counts.push_back(counts[n].get<std::uint64_t>());
  }
  h.refuseOthers();
  o.refuseOthers();
  return s;
}

Origin readOrigin(const ObjectReader& o) {
  constexpr auto last = static_cast<std::size_t>(Origin::File);
  std::array<const char*, last + 1> words{};
  for (std::size_t n = 0; n <= last; ++n) words[n] = nameOf(static_cast<Origin>(n));
  return static_cast<Origin>(choice(o, "origin", words));
}

Measured readMeasured(const ObjectReader& o, Space space) {
  Measured m;
  const nlohmann::json& quantities = o.array("quantities");
  if (quantities.size() > kMostListed) throw JsonFault{"The list is too long.", o.pathOf("quantities")};
  for (std::size_t n = 0; n < quantities.size(); ++n)
    m.quantities.push_back(readQuantity(ObjectReader(quantities[n], pointerTo(o.pathOf("quantities"), n))));
  m.origin = readOrigin(o);
  m.originText = o.text("millimetres");
  if (o.has("statistics"))
    m.values = readStatistics(ObjectReader(o.child("statistics"), o.pathOf("statistics")));
  const nlohmann::json& notes = o.array("notes");
  for (std::size_t n = 0; n < notes.size(); ++n) {
    if (!notes[n].is_string()) throw JsonFault{"Text is expected here.", pointerTo(o.pathOf("notes"), n)};
    m.notes.push_back(notes[n].get<std::string>());
  }
  if (o.has("found")) m.found = ShapeReader(o, space).spots("found");
  m.sopInstanceUid = o.textOr("sop_instance_uid");
  m.frameOfReferenceUid = o.textOr("frame_of_reference_uid");
  if (o.has("frame_number")) m.frameNumber = static_cast<std::int64_t>(o.count("frame_number", kMostFrames));
  o.refuseOthers();
  return m;
}

Entry readEntry(const ObjectReader& o) {
  Entry e;
  e.what.id = o.textOr("id");
  e.what.label = o.textOr("label");
  const std::string kind = o.text("kind");
  e.what.on = readPlacement(o);
  e.what.shape = ShapeReader(o, e.what.on.space).read(kind);
  if (o.has("result"))
    e.said = readMeasured(ObjectReader(o.child("result"), o.pathOf("result")), e.what.on.space);
  e.refused = o.textOr("refused");
  o.refuseOthers();
  return e;
}

std::vector<Entry> readAll(std::string_view json) {
  const nlohmann::json document = parseJson(json);
  const ObjectReader top(document, "");
  const std::uint64_t schema = top.count("schema", std::numeric_limits<std::uint64_t>::max());
  if (schema == 0 || schema > static_cast<std::uint64_t>(kMeasurementSchema))
    throw JsonFault{"The file has schema " + std::to_string(schema) + ", this program reads up to " +
                        std::to_string(kMeasurementSchema) + "; open it with a newer Vernier.",
                    "/schema"};
  if (top.has("expanded")) top.text("expanded");
  const nlohmann::json& list = top.array("measurements");
  top.refuseOthers();
  if (list.size() > kMostMeasurements)
    throw JsonFault{"The file has " + std::to_string(list.size()) + " measurements, at most " +
                        std::to_string(kMostMeasurements) + " are read.",
                    "/measurements"};
  std::vector<Entry> entries;
  std::set<std::string> ids;
  for (std::size_t n = 0; n < list.size(); ++n) {
    const std::string path = pointerTo("/measurements", n);
    entries.push_back(readEntry(ObjectReader(list[n], path)));
    const std::string& id = entries.back().what.id;
    if (!id.empty() && !ids.insert(id).second)
      throw JsonFault{"The id '" + id + "' stands here twice; each measurement has its own.", path + "/id"};
  }
  return entries;
}

}  // namespace

Result<std::vector<Entry>> parseMeasurements(std::string_view json) {
  try {
    return readAll(json);
  } catch (const JsonFault& fault) {
    return makeError(ErrorCode::OptionInvalid, fault.sentence, fault.path);
  } catch (const std::exception&) {
    return errorFromCurrentException("measurements");
  }
}

}  // namespace vernier::measure
