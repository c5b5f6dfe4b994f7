// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes as JSON: the layers that look through a volume, and what cuts it.
#include <algorithm>

#include "SceneReader.h"
#include "SceneWriter.h"

namespace vernier {
namespace {

constexpr Name<ProjectionMode> kModes[] = {{ProjectionMode::Max, "max"},
                                           {ProjectionMode::Min, "min"},
                                           {ProjectionMode::Sum, "sum"},
                                           {ProjectionMode::Mean, "mean"},
                                           {ProjectionMode::Attenuation, "attenuation"}};
constexpr Name<ShellsMode> kShells[] = {
    {ShellsMode::Max, "max"}, {ShellsMode::Sum, "sum"}, {ShellsMode::Lit, "lit"}};
constexpr Name<SurfaceBlend> kBlends[] = {{SurfaceBlend::Replace, "replace"}, {SurfaceBlend::Max, "max"}};
constexpr Name<LevelSpread> kSpreads[] = {{LevelSpread::Even, "even"}, {LevelSpread::Histogram, "histogram"}};

double atLeast0(const ObjectReader& o, const std::string& key) {
  const double x = o.number(key);
  if (!(x >= 0)) throw JsonFault{"The number must not be below 0.", o.pathOf(key)};
  return x;
}

glm::dvec3 vec3(const ObjectReader& o, const std::string& key) {
  const std::array<double, 3> v = o.numbers<3>(key);
  return {v[0], v[1], v[2]};
}

// A list of modality values, or how many there are to be.
void readLevels(const ObjectReader& o, ShellsLayer& l) {
  const nlohmann::json& v = o.child("levels");
  const std::string path = o.pathOf("levels"), most = std::to_string(kMostLevels);
  if (!v.is_array()) {
    l.count = static_cast<int>(o.integer("levels", 1, kMostLevels));
    return;
  }
  if (v.empty() || v.size() > static_cast<std::size_t>(kMostLevels))
    throw JsonFault{"There may be 1 to " + most + " levels.", path};
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (!v[i].is_number()) throw JsonFault{"A level is a number.", pointerTo(path, i)};
    l.levels.push_back(v[i].get<double>());
    if (i > 0 && !(l.levels[i] > l.levels[i - 1]))
      throw JsonFault{"The levels must ascend, each above the one before.", pointerTo(path, i)};
  }
}

}  // namespace

ProjectionLayer readProjection(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  ProjectionLayer l;
  o.text("kind");
  l.source = o.text("source");
  if (o.has("mode")) l.mode = choice(o, "mode", kModes);
  if (o.has("interpolation")) l.interpolation = readInterpolation(o, "interpolation");
  if (l.interpolation == Interpolation::Cubic)
    throw JsonFault{"Projections interpolate with nearest or linear; cubic is for slices.",
                    o.pathOf("interpolation")};
  if (o.has("window")) l.window = readWindow(o.child("window"), o.pathOf("window"));
  if (o.has("invert")) l.invert = o.flag("invert");
  if (o.has("cue")) l.cue = o.number("cue");
  if (!(l.cue >= 0 && l.cue <= 1)) throw JsonFault{"The depth cue lies between 0 and 1.", o.pathOf("cue")};
  if (l.cue > 0 && l.mode != ProjectionMode::Max)
    throw JsonFault{"A depth cue belongs to the mode max.", o.pathOf("cue")};
  if (o.has("gain_per_mm")) l.gain_perMm = above0(o, "gain_per_mm");
  o.refuseOthers();
  return l;
}

ShellsLayer readShells(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  ShellsLayer l;
  o.text("kind");
  l.source = o.text("source");
  if (o.has("mode")) l.mode = choice(o, "mode", kShells);
  if (o.has("levels")) readLevels(o, l);
  if (o.has("spread")) l.spread = choice(o, "spread", kSpreads);
  if (o.has("disabled")) {
    const nlohmann::json& list = o.array("disabled");
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (!list[i].is_number_integer() || list[i].get<std::int64_t>() < 0 ||
          list[i].get<std::int64_t>() >= kMostLevels)
        throw JsonFault{"A disabled level is named by its place in the list, from 0.",
                        pointerTo(o.pathOf("disabled"), i)};
      l.disabled.push_back(list[i].get<int>());
    }
  }
  if (o.has("window")) l.window = readWindow(o.child("window"), o.pathOf("window"));
  if (o.has("beta0")) l.beta0 = atLeast0(o, "beta0");
  if (o.has("beta_m")) l.betaM = above0(o, "beta_m");
  if (o.has("a")) l.a = atLeast0(o, "a");
  if (o.has("b")) l.b = atLeast0(o, "b");
  if (o.has("phi0")) l.phi0 = atLeast0(o, "phi0");
  if (o.has("cue_by_distance")) l.cueByDistance = o.flag("cue_by_distance");
  if (o.has("colour")) l.colour = readRgb(o, "colour");
  if (o.has("surface_blend")) l.surfaceBlend = choice(o, "surface_blend", kBlends);
  if (l.surfaceBlend == SurfaceBlend::Max && l.mode != ShellsMode::Max)
    throw JsonFault{"How surfaces blend is a choice of the mode max.", o.pathOf("surface_blend")};
  o.refuseOthers();
  return l;
}

CropBox readCrop(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  const CropBox box{VoxelPoint(vec3(o, "from")), VoxelPoint(vec3(o, "to"))};
  if (!glm::all(glm::lessThan(box.least.p, box.greatest.p)))
    throw JsonFault{"The crop box is empty: 'from' must lie below 'to' along each axis.", path};
  o.refuseOthers();
  return box;
}

std::vector<HalfSpace> readClip(const nlohmann::json& list, const std::string& path) {
  if (!list.is_array()) throw JsonFault{"A list of clip planes is expected here.", path};
  std::vector<HalfSpace> planes;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const ObjectReader o(list[i], pointerTo(path, i));
    const glm::dvec3 normal = vec3(o, "normal");
    const double offset = o.number("offset_mm"), length = glm::length(normal);
    if (!(length > 0) || !std::isfinite(length))
      throw JsonFault{"A clip plane needs a normal that is not 0.", o.pathOf("normal")};
    o.refuseOthers();
    planes.push_back({PatientVec(normal), offset});
  }
  return planes;
}

std::string write(const ProjectionLayer& l) {
  return cat("{\"kind\": \"projection\", \"source\": ", text(l.source), ", \"mode\": \"",
             nameIn(kModes, l.mode), "\", \"interpolation\": \"", nameOf(l.interpolation), "\"",
             l.window ? cat(", \"window\": ", write(*l.window)) : "", ", \"invert\": ", flag(l.invert),
             ", \"cue\": ", number(l.cue),
             l.gain_perMm ? cat(", \"gain_per_mm\": ", number(*l.gain_perMm)) : "", "}");
}

std::string write(const ShellsLayer& l) {
  std::string levels, disabled;
  for (double v : l.levels) levels += cat(levels.empty() ? "" : ", ", number(v));
  for (int n : l.disabled) disabled += cat(disabled.empty() ? "" : ", ", std::to_string(n));
  return cat("{\"kind\": \"shells\", \"source\": ", text(l.source), ", \"mode\": \"", nameIn(kShells, l.mode),
             "\", \"levels\": ", l.levels.empty() ? std::to_string(l.count) : cat("[", levels, "]"),
             ", \"spread\": \"", nameIn(kSpreads, l.spread), "\", \"disabled\": [", disabled, "]",
             l.window ? cat(", \"window\": ", write(*l.window)) : "", ", \"beta0\": ", number(l.beta0),
             ", \"beta_m\": ", number(l.betaM), ", \"a\": ", number(l.a), ", \"b\": ", number(l.b),
             ", \"phi0\": ", number(l.phi0), ", \"cue_by_distance\": ", flag(l.cueByDistance),
             ", \"colour\": ", vec({l.colour.r, l.colour.g, l.colour.b}), ", \"surface_blend\": \"",
             nameIn(kBlends, l.surfaceBlend), "\"}");
}

std::string write(const CropBox& box) {
  return cat("{\"from\": ", vec(box.least.p), ", \"to\": ", vec(box.greatest.p), "}");
}

std::string write(const std::vector<HalfSpace>& planes) {
  std::string out;
  for (const HalfSpace& plane : planes)
    out += cat(out.empty() ? "" : ", ", "{\"normal\": ", vec(plane.normal.v),
               ", \"offset_mm\": ", number(plane.offset_mm), "}");
  return cat("[", out, "]");
}

}  // namespace vernier
