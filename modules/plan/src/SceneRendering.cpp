// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes as JSON: transfer functions, volume and iso-surface layers, lights.
#include "SceneReader.h"
#include "SceneWriter.h"
#include "vernier/plan/SceneJson.h"

namespace vernier {
namespace {

constexpr Name<VolumeMode> kModes[] = {
    {VolumeMode::Blend, "blend"}, {VolumeMode::Max, "max"}, {VolumeMode::Min, "min"}};
constexpr Name<Classification> kClassifications[] = {{Classification::Post, "post"},
                                                     {Classification::Pre, "pre"},
                                                     {Classification::PreIntegrated, "pre-integrated"}};
constexpr Name<OpacityRule> kRules[] = {{OpacityRule::Exact, "exact"}, {OpacityRule::Linear, "linear"}};
constexpr Name<ShadingModel> kModels[] = {{ShadingModel::None, "none"},
                                          {ShadingModel::GlobalAmbient, "global-ambient"},
                                          {ShadingModel::ColourPerVoxel, "colour-per-voxel"}};

double from0(const ObjectReader& o, const std::string& key, double most) {
  const double x = o.number(key);
  if (!(x >= 0 && x <= most))
    throw JsonFault{"The number lies between 0 and " + number(most) + ".", o.pathOf(key)};
  return x;
}

// One point of a list: [value, ...], N numbers in all.
template <std::size_t N>
std::array<double, N> pointAt(const nlohmann::json& list, std::size_t i, const std::string& path) {
  const nlohmann::json& p = list[i];
  const std::string where = pointerTo(path, i);
  if (!p.is_array() || p.size() != N)
    throw JsonFault{"A point is a list of " + std::to_string(N) + " numbers.", where};
  std::array<double, N> out{};
  for (std::size_t k = 0; k < N; ++k) {
    if (!p[k].is_number()) throw JsonFault{"A number is expected here.", pointerTo(where, k)};
    out[k] = p[k].get<double>();
  }
  return out;
}

const nlohmann::json& pointList(const ObjectReader& o, const std::string& key) {
  const nlohmann::json& list = o.array(key);
  if (list.size() > kMostTransferPoints)
    throw JsonFault{"The list has " + std::to_string(list.size()) + " points; at most " +
                        std::to_string(kMostTransferPoints) + " are taken.",
                    o.pathOf(key)};
  return list;
}

TransferFunction readTransfer(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  TransferFunction f;
  const nlohmann::json& colours = pointList(o, "colours");
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const auto p = pointAt<4>(colours, i, o.pathOf("colours"));
    f.colours.push_back({p[0], {p[1], p[2], p[3]}});
  }
  const nlohmann::json& opacities = pointList(o, "opacities");
  for (std::size_t i = 0; i < opacities.size(); ++i) {
    const auto p = pointAt<2>(opacities, i, o.pathOf("opacities"));
    f.opacities.push_back({p[0], p[1]});
  }
  if (o.has("opacity_length_mm")) f.opacityLength_mm = o.number("opacity_length_mm");
  o.refuseOthers();
  if (const Result<void> ok = checkTransferFunction(f); !ok)
    throw JsonFault{ok.error().sentence, path + ok.error().where};
  return f;
}

Material readMaterial(const nlohmann::json& value, const std::string& path, Material m) {
  const ObjectReader o(value, path);
  if (o.has("ambient")) m.ambient = from0(o, "ambient", 1);
  if (o.has("diffuse")) m.diffuse = from0(o, "diffuse", 1);
  if (o.has("specular")) m.specular = from0(o, "specular", 1);
  if (o.has("power")) m.power = from0(o, "power", 1000);
  if (o.has("ambient_colour")) m.ambientColour = readRgb(o, "ambient_colour");
  if (o.has("diffuse_colour")) m.diffuseColour = readRgb(o, "diffuse_colour");
  o.refuseOthers();
  return m;
}

std::string writeRgb(const Rgb& c) { return vec({c.r, c.g, c.b}); }

std::string writeMaterial(const Material& m) {
  return cat("{\"ambient\": ", number(m.ambient), ", \"diffuse\": ", number(m.diffuse),
             ", \"specular\": ", number(m.specular), ", \"power\": ", number(m.power),
             ", \"ambient_colour\": ", writeRgb(m.ambientColour),
             ", \"diffuse_colour\": ", writeRgb(m.diffuseColour), "}");
}

}  // namespace

std::string write(const TransferFunction& f) {
  std::string colours, opacities;
  for (const ColourPoint& p : f.colours)
    colours += cat(colours.empty() ? "" : ", ", "[", number(p.value), ", ", number(p.colour.x), ", ",
                   number(p.colour.y), ", ", number(p.colour.z), "]");
  for (const OpacityPoint& p : f.opacities)
    opacities += cat(opacities.empty() ? "" : ", ", "[", number(p.value), ", ", number(p.opacity), "]");
  return cat("{\"colours\": [", colours, "], \"opacities\": [", opacities,
             "], \"opacity_length_mm\": ", number(f.opacityLength_mm), "}");
}

VolumeLayer readVolume(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  VolumeLayer l;
  o.text("kind");
  l.source = o.text("source");
  if (o.has("mode")) l.mode = choice(o, "mode", kModes);
  if (o.has("preset")) l.preset = o.text("preset");
  if (o.has("transfer")) l.transfer = readTransfer(o.child("transfer"), o.pathOf("transfer"));
  if (o.has("gains")) {
    l.gains = o.numbers<4>("gains");
    for (double g : l.gains)
      if (!(g >= 0 && g <= 1000)) throw JsonFault{"A gain lies between 0 and 1000.", o.pathOf("gains")};
  }
  if (o.has("classification")) l.classification = choice(o, "classification", kClassifications);
  if (o.has("opacity_rule")) l.opacity = choice(o, "opacity_rule", kRules);
  if (o.has("interpolation")) l.interpolation = readInterpolation(o, "interpolation");
  if (l.interpolation == Interpolation::Cubic)
    throw JsonFault{"Volumes are rendered with nearest or linear; cubic is for slices.",
                    o.pathOf("interpolation")};
  if (o.has("shading")) l.shading = choice(o, "shading", kModels);
  if (o.has("material")) l.material = readMaterial(o.child("material"), o.pathOf("material"), l.material);
  if (o.has("combiner")) l.combiner = o.text("combiner");
  if (o.has("outlines")) l.outlines = o.flag("outlines");
  o.refuseOthers();
  return l;
}

IsosurfaceLayer readIsosurface(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  IsosurfaceLayer l;
  o.text("kind");
  l.source = o.text("source");
  if (o.has("level")) l.level = o.number("level");
  if (o.has("material")) l.material = readMaterial(o.child("material"), o.pathOf("material"), l.material);
  if (o.has("combiner")) l.combiner = o.text("combiner");
  o.refuseOthers();
  return l;
}

std::vector<Light> readLights(const nlohmann::json& list, const std::string& path) {
  if (!list.is_array()) throw JsonFault{"A list of lights is expected here.", path};
  if (list.size() > kMostLights)
    throw JsonFault{"There may be at most " + std::to_string(kMostLights) + " lights.", path};
  std::vector<Light> lights;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const ObjectReader o(list[i], pointerTo(path, i));
    Light light;
    if (o.has("towards")) {
      const std::array<double, 3> v = o.numbers<3>("towards");
      const double length = glm::length(glm::dvec3(v[0], v[1], v[2]));
      if (!(length > 0) || !std::isfinite(length))
        throw JsonFault{"A light needs a direction that is not 0.", o.pathOf("towards")};
      light.towards = PatientVec(v[0], v[1], v[2]);
    }
    if (o.has("colour")) light.colour = readRgb(o, "colour");
    o.refuseOthers();
    lights.push_back(light);
  }
  return lights;
}

std::string write(const VolumeLayer& l) {
  return cat(
      "{\"kind\": \"volume\", \"source\": ", text(l.source), ", \"mode\": \"", nameIn(kModes, l.mode), "\"",
      l.preset.empty() ? "" : cat(", \"preset\": ", text(l.preset)),
      l.transfer ? cat(", \"transfer\": ", write(*l.transfer)) : "", ", \"gains\": [", number(l.gains[0]),
      ", ", number(l.gains[1]), ", ", number(l.gains[2]), ", ", number(l.gains[3]), "]",
      l.classification ? cat(", \"classification\": \"", nameIn(kClassifications, *l.classification), "\"")
                       : "",
      ", \"opacity_rule\": \"", nameIn(kRules, l.opacity), "\", \"interpolation\": \"",
      nameOf(l.interpolation), "\", \"shading\": \"", nameIn(kModels, l.shading),
      "\", \"material\": ", writeMaterial(l.material),
      l.combiner.empty() ? "" : cat(", \"combiner\": ", text(l.combiner)),
      ", \"outlines\": ", flag(l.outlines), "}");
}

std::string write(const IsosurfaceLayer& l) {
  return cat("{\"kind\": \"isosurface\", \"source\": ", text(l.source),
             l.level ? cat(", \"level\": ", number(*l.level)) : "",
             ", \"material\": ", writeMaterial(l.material),
             l.combiner.empty() ? "" : cat(", \"combiner\": ", text(l.combiner)), "}");
}

std::string write(const std::vector<Light>& lights) {
  std::string out;
  for (const Light& light : lights)
    out += cat(out.empty() ? "" : ", ", "{",
               light.towards ? cat("\"towards\": ", vec(light.towards->v), ", ") : "",
               "\"colour\": ", writeRgb(light.colour), "}");
  return cat("[", out, "]");
}

std::string writeTransfer(const TransferFunction& f) { return write(f) + "\n"; }

Result<TransferFunction> parseTransfer(std::string_view json) {
  if (json.starts_with("\xEF\xBB\xBF")) json.remove_prefix(3);
  return parsedScene<TransferFunction>(
      [&] { return Result<TransferFunction>(readTransfer(parseJson(json), "")); });
}

}  // namespace vernier
