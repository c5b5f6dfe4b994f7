// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes as JSON: lenses.
#include "SceneReader.h"
#include "SceneWriter.h"
#include "vernier/plan/SceneJson.h"

namespace vernier {
namespace {

MeshPoint pointOf(const ObjectReader& o, const std::string& key) {
  const std::array<double, 3> p = o.numbers<3>(key);
  return MeshPoint(p[0], p[1], p[2]);
}

double radiusOf(const ObjectReader& o, const std::string& key) {
  const double r = o.number(key);
  if (!(r >= 0)) throw JsonFault{"A radius is a number of millimetres, 0 or above.", o.pathOf(key)};
  return r;
}

HullShape readHull(const ObjectReader& o) {
  HullShape h;
  const nlohmann::json& list = o.array("points");
  for (std::size_t n = 0; n < list.size(); ++n) {
    const nlohmann::json& p = list[n];
    if (!p.is_array() || p.size() != 3 || !p[0].is_number() || !p[1].is_number() || !p[2].is_number())
      throw JsonFault{"A point is a list of three numbers, mm in the lens's own frame.",
                      pointerTo(o.pathOf("points"), n)};
    h.points.emplace_back(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
  }
  return h;
}

ConeShape readCone(const ObjectReader& o, bool cylinder) {
  ConeShape c;
  c.from = pointOf(o, "from"), c.to = pointOf(o, "to");
  if (cylinder) {
    c.fromRadius_mm = c.toRadius_mm = above0(o, "radius_mm");
  } else {
    c.fromRadius_mm = radiusOf(o, "from_radius_mm"), c.toRadius_mm = radiusOf(o, "to_radius_mm");
  }
  if (o.has("sides")) c.sides = static_cast<int>(o.integer("sides", 3, 1000));
  return c;
}

LensShape readShape(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  const std::string kind = o.text("kind");
  LensShape shape;
  if (kind == "box") {
    BoxShape b;
    if (o.has("centre")) b.centre = pointOf(o, "centre");
    const std::array<double, 3> size = o.numbers<3>("size_mm");
    b.size_mm = {size[0], size[1], size[2]};
    shape = b;
  } else if (kind == "sphere") {
    SphereShape s;
    if (o.has("centre")) s.centre = pointOf(o, "centre");
    s.radius_mm = above0(o, "radius_mm");
    if (o.has("divisions")) s.divisions = static_cast<int>(o.integer("divisions", 0, 5));
    shape = s;
  } else if (kind == "cone" || kind == "cylinder") {
    shape = readCone(o, kind == "cylinder");
  } else if (kind == "hull") {
    shape = readHull(o);
  } else if (kind == "mesh") {
    MeshShape m;
    m.source = o.text("source");
    if (o.has("hull")) m.hull = o.flag("hull");
    shape = m;
  } else {
    throw JsonFault{"'" + kind + "' is none of: box, sphere, cylinder, cone, hull, mesh.", o.pathOf("kind")};
  }
  o.refuseOthers();
  return shape;
}

SliceLook readLook(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  SliceLook l;
  o.text("kind");
  if (o.has("interpolation")) l.interpolation = readInterpolation(o, "interpolation");
  if (o.has("window")) l.window = readWindow(o.child("window"), o.pathOf("window"));
  if (o.has("invert")) l.invert = o.flag("invert");
  o.refuseOthers();
  return l;
}

LensInner readInner(const nlohmann::json& value, const std::string& path) {
  const std::string kind = kindAt(value, path);
  if (kind == "slice") return readLook(value, path);
  if (kind == "projection") return readProjection(value, path);
  if (kind == "shells") return readShells(value, path);
  if (kind == "volume") return readVolume(value, path);
  if (kind == "isosurface") return readIsosurface(value, path);
  if (kind != "cut-out")
    throw JsonFault{"'" + kind + "' is none of: cut-out, slice, projection, shells, volume, isosurface.",
                    pointerTo(path, std::string("kind"))};
  const ObjectReader o(value, path);
  o.text("kind");
  o.refuseOthers();
  return CutOut{};
}

std::string point(const MeshPoint& p) { return vec(p.p); }

std::string write(const BoxShape& b) {
  return cat("{\"kind\": \"box\", \"centre\": ", point(b.centre), ", \"size_mm\": ", vec(b.size_mm), "}");
}
std::string write(const SphereShape& s) {
  return cat("{\"kind\": \"sphere\", \"centre\": ", point(s.centre), ", \"radius_mm\": ", number(s.radius_mm),
             ", \"divisions\": ", std::to_string(s.divisions), "}");
}
std::string write(const ConeShape& c) {
  return cat("{\"kind\": \"cone\", \"from\": ", point(c.from), ", \"to\": ", point(c.to),
             ", \"from_radius_mm\": ", number(c.fromRadius_mm), ", \"to_radius_mm\": ", number(c.toRadius_mm),
             ", \"sides\": ", std::to_string(c.sides), "}");
}
std::string write(const HullShape& h) {
  std::string points;
  for (const MeshPoint& p : h.points) points += cat(points.empty() ? "" : ", ", point(p));
  return cat("{\"kind\": \"hull\", \"points\": [", points, "]}");
}
std::string write(const MeshShape& m) {
  return cat("{\"kind\": \"mesh\", \"source\": ", text(m.source), ", \"hull\": ", flag(m.hull), "}");
}

std::string write(const CutOut&) { return "{\"kind\": \"cut-out\"}"; }
std::string write(const SliceLook& l) {
  return cat("{\"kind\": \"slice\", \"interpolation\": \"", nameOf(l.interpolation), "\"",
             l.window ? cat(", \"window\": ", vernier::write(*l.window)) : "",
             ", \"invert\": ", flag(l.invert), "}");
}

}  // namespace

std::string write(const LensLayer& l) {
  const auto one = [](const auto& part) { return write(part); };
  return cat("{\"kind\": \"lens\", \"shape\": ", std::visit(one, l.shape), ", \"pose\": ", write(l.pose),
             ", \"inner\": ", std::visit(one, l.inner), "}");
}

LensLayer readLens(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  LensLayer l;
  o.text("kind");
  l.shape = readShape(o.child("shape"), o.pathOf("shape"));
  if (o.has("pose")) l.pose = readPose(o, "pose");
  if (o.has("inner")) l.inner = readInner(o.child("inner"), o.pathOf("inner"));
  o.refuseOthers();
  return l;
}

}  // namespace vernier
