// SPDX-License-Identifier: GPL-3.0-or-later
// Written by hand: the order of keys and the shape of numbers are ours to keep.
#include <cmath>
#include <nlohmann/json.hpp>

#include "../Numbers.h"
#include "Keys.h"
#include "vernier/measure/MeasurementJson.h"

namespace vernier::measure {
namespace {

template <class... Parts>
std::string cat(const Parts&... parts) {
  std::string out;
  ((out += parts), ...);
  return out;
}
std::string number(double x) {
  if (!std::isfinite(x)) return "null";
  if (x == 0 && std::signbit(x)) return "-0.0";  // "-0" would come back as the integer 0
  return shortest(x);
}
std::string text(const std::string& s) {
  return nlohmann::json(s).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}
std::string vec(glm::dvec3 v) { return cat("[", number(v.x), ", ", number(v.y), ", ", number(v.z), "]"); }
template <class List, class Fn>
std::string list(const List& items, Fn&& one) {
  std::string out;
  for (const auto& x : items) out += cat(out.empty() ? "" : ", ", one(x));
  return "[" + out + "]";
}

class Writer {
 public:
  explicit Writer(Space space) : space_(space) {}
  std::string spot(const Spot& p) const {
    return space_ == Space::Image ? cat("[", number(p.x), ", ", number(p.y), "]") : vec(p);
  }
  template <class List>
  std::string spots(const char* key, const List& points) const {
    return cat(", \"", key, "\": ", list(points, [&](const Spot& p) { return spot(p); }));
  }
  std::string one(const char* key, const Spot& p) const { return cat(", \"", key, "\": ", spot(p)); }
  std::string surface(const char* key, const SurfaceRef& s) const {
    std::string out = cat(", \"", key, "\": {");
    if (s.level_val) return cat(out, "\"level\": ", number(*s.level_val), "}");
    const glm::dmat4 m = s.pose.matrix();
    std::string pose;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        pose += cat(pose.empty() ? "" : ", ", number(m[column][row]));
    return cat(out, "\"name\": ", text(s.name), ", \"pose\": [", pose, "]}");
  }

  std::string operator()(const Length& s) const { return spots("points", s.ends); }
  std::string operator()(const Bidirectional& s) const {
    return spots("long", s.longAxis) + spots("short", s.shortAxis);
  }
  std::string operator()(const Angle& s) const {
    return spots("points", std::array{s.arms[0], s.vertex, s.arms[1]});
  }
  std::string operator()(const Cobb& s) const { return spots("first", s.first) + spots("second", s.second); }
  std::string operator()(const RectangleRegion& s) const { return spots("points", s.corners); }
  std::string operator()(const EllipseRegion& s) const { return spots("points", s.corners); }
  std::string operator()(const PolygonRegion& s) const { return spots("points", s.corners); }
  std::string operator()(const FreehandRegion& s) const { return spots("points", s.outline); }
  std::string operator()(const ThresholdRegion& s) const {
    return cat(", \"level\": ", number(s.level_val)) + one("seed", s.seed);
  }
  std::string operator()(const Probe& s) const { return one("point", s.at); }
  std::string operator()(const PointToSurface& s) const {
    return one("point", s.point) + surface("surface", s.surface);
  }
  std::string operator()(const ToolToVessel& s) const {
    return surface("tool", s.tool) + surface("vessel", s.vessel);
  }
  std::string operator()(const IsoVolume& s) const {
    return cat(", \"level\": ", number(s.level_val), s.seed ? one("seed", *s.seed) : "");
  }
  std::string operator()(const ConvexVolume& s) const {
    return cat(", \"planes\": ", list(s.planes, [](const HalfSpace& h) {
                 return cat("{\"normal\": ", vec(h.normal.v), ", \"offset_mm\": ", number(h.offset_mm), "}");
               }));
  }
  std::string operator()(const SurfaceVolume& s) const { return surface("surface", s.surface); }
  std::string operator()(const Arrow& s) const {
    return cat(spots("points", std::array{s.tip, s.tail}), ", \"text\": ", text(s.text));
  }
  std::string operator()(const Text& s) const {
    return cat(one("point", s.at), ", \"text\": ", text(s.text));
  }

 private:
  Space space_;
};

std::string write(const Quantity& q) {
  return cat("{\"name\": ", text(q.name), ", \"value\": ", number(q.value), ", \"unit\": ", text(q.unit),
             q.expanded ? cat(", \"expanded\": ", number(*q.expanded)) : "",
             ", \"text\": ", text(displayText(q)), "}");
}

std::string write(const Statistics& s) {
  const Histogram& h = s.histogram;
  return cat("{\"n\": ", std::to_string(s.n), ", \"no_data\": ", std::to_string(s.noData),
             ", \"min\": ", number(s.min), ", \"max\": ", number(s.max), ", \"mean\": ", number(s.mean),
             ", \"median\": ", number(s.median), s.sd ? cat(", \"sd\": ", number(*s.sd)) : "",
             ", \"effective_n\": ", number(s.effective),
             ",\n          \"histogram\": {\"first\": ", number(h.first), ", \"width\": ", number(h.width),
             ", \"counts\": ", list(h.counts, [](std::uint64_t n) { return std::to_string(n); }), "}}");
}

std::string write(const Measured& m, Space space) {
  const Writer w(space);
  return cat(
      "{\n        \"quantities\": [",
      [&] {
        std::string out;
        for (const Quantity& q : m.quantities)
          out += cat(out.empty() ? "\n          " : ",\n          ", write(q));
        return out;
      }(),
      "],\n        \"origin\": \"", nameOf(m.origin), "\", \"millimetres\": ", text(m.originText),
      m.values ? cat(",\n        \"statistics\": ", write(*m.values)) : "",
      ",\n        \"notes\": ", list(m.notes, text), m.found.empty() ? "" : w.spots("found", m.found),
      m.sopInstanceUid.empty() ? "" : cat(", \"sop_instance_uid\": ", text(m.sopInstanceUid)),
      m.frameOfReferenceUid.empty() ? "" : cat(", \"frame_of_reference_uid\": ", text(m.frameOfReferenceUid)),
      m.frameNumber != 0 ? cat(", \"frame_number\": ", std::to_string(m.frameNumber)) : "", "}");
}

std::string write(const Placement& p) {
  return cat(", \"space\": \"", wordOf(p.space), "\", \"source\": ", text(p.source),
             p.space == Space::Image ? cat(", \"frame\": ", std::to_string(p.frame)) : "", ", \"shown\": \"",
             wordOf(p.shown), "\"",
             p.axes ? cat(", \"normal\": ", vec(p.axes->normal.v), ", \"up\": ", vec(p.axes->up.v)) : "",
             ", \"screen_pixel\": ", number(p.screenPixel),
             p.userSpacing_mm ? cat(", \"user_spacing_mm\": [", number(p.userSpacing_mm->x), ", ",
                                    number(p.userSpacing_mm->y), "]")
                              : "");
}

std::string write(const Entry& e) {
  const Measurement& m = e.what;
  return cat("{\"id\": ", text(m.id), ", \"kind\": \"", kindOf(m.shape), "\", \"label\": ", text(m.label),
             write(m.on), std::visit(Writer(m.on.space), m.shape),
             e.said ? cat(",\n      \"result\": ", write(*e.said, m.on.space)) : "",
             e.refused.empty() ? "" : cat(", \"refused\": ", text(e.refused)), "}");
}

}  // namespace

std::string writeMeasurements(const std::vector<Entry>& entries) {
  std::string out;
  for (const Entry& e : entries) out += cat(out.empty() ? "\n    " : ",\n    ", write(e));
  return cat("{\n  \"schema\": ", std::to_string(kMeasurementSchema), ",\n  \"expanded\": \"k = 2; ",
             kNotIncluded, "\",\n  \"measurements\": [", out, out.empty() ? "]\n}\n" : "\n  ]\n}\n");
}

}  // namespace vernier::measure
