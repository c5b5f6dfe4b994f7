// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/SceneJson.h"

#include <limits>

#include "JsonText.h"
#include "SceneReader.h"
#include "SceneWriter.h"

namespace vernier {

std::string write(const VoiWindow& w) {
  return cat("{\"center\": ", number(w.center), ", \"width\": ", number(w.width), ", \"function\": \"",
             nameOf(w.function), "\", \"explanation\": ", text(w.explanation), "}");
}

std::string write(const PatientFromMesh& pose) {
  const glm::dmat4 m = pose.matrix();
  std::string out;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) out += cat(out.empty() ? "[" : ", ", number(m[column][row]));
  return out + "]";
}

namespace {

std::string write(const Camera& c) {
  return cat("{\"azimuth_deg\": ", number(c.azimuth_deg), ", \"elevation_deg\": ", number(c.elevation_deg),
             ", \"roll_deg\": ", number(c.roll_deg), ", \"projection\": \"", nameOf(c.projection),
             "\", \"fov_deg\": ", number(c.fov_deg), ", \"zoom\": ", number(c.zoom),
             c.height_mm ? cat(", \"height_mm\": ", number(*c.height_mm)) : "", ", \"pan_mm\": [",
             number(c.pan_mm.x), ", ", number(c.pan_mm.y), "]",
             c.target ? cat(", \"target_mm\": ", vec(c.target->p)) : "",
             c.distance_mm ? cat(", \"distance_mm\": ", number(*c.distance_mm)) : "",
             c.near_mm != 0 ? cat(", \"near_mm\": ", number(c.near_mm)) : "", "}");
}
std::string write(const ImageLayer& l) {
  return cat("{\"kind\": \"image\", \"source\": ", text(l.source), ", \"index\": ", std::to_string(l.index),
             l.window ? cat(", \"window\": ", write(*l.window)) : "",
             l.voiLut ? cat(", \"voi_lut\": ", std::to_string(*l.voiLut)) : "", ", \"interpolation\": \"",
             nameOf(l.interpolation), "\", \"invert\": ", flag(l.invert),
             ", \"flip_horizontal\": ", flag(l.flipHorizontal), ", \"flip_vertical\": ", flag(l.flipVertical),
             l.presentation.empty() ? "" : cat(", \"presentation\": ", text(l.presentation)), "}");
}
std::string write(const SliceLayer& l) {
  return cat("{\"kind\": \"slice\", \"source\": ", text(l.source),
             ", \"plane\": {\"point\": ", vec(l.plane.point.p), ", \"normal\": ", vec(l.plane.normal.v),
             ", \"up\": ", vec(l.plane.up.v), "}, \"slab\": {\"thickness_mm\": ", number(l.slab.thickness_mm),
             ", \"mode\": \"", nameOf(l.slab.mode), "\"}, \"interpolation\": \"", nameOf(l.interpolation),
             "\"", l.window ? cat(", \"window\": ", write(*l.window)) : "", ", \"invert\": ", flag(l.invert),
             "}");
}
std::string write(const CurvedLayer& l) {
  std::string path;
  for (const PatientPoint& p : l.path) path += cat(path.empty() ? "" : ", ", vec(p.p));
  return cat("{\"kind\": \"curved\", \"source\": ", text(l.source), ", \"path\": [", path, "], \"form\": \"",
             nameOf(l.form), "\"", l.up ? cat(", \"up\": ", vec(l.up->v)) : "",
             ", \"width_mm\": ", number(l.width_mm),
             ", \"slab\": {\"thickness_mm\": ", number(l.slab.thickness_mm), ", \"mode\": \"",
             nameOf(l.slab.mode), "\"}, \"interpolation\": \"", nameOf(l.interpolation), "\"",
             l.window ? cat(", \"window\": ", write(*l.window)) : "", ", \"invert\": ", flag(l.invert), "}");
}
std::string write(const SurfaceLayer& l) {
  return cat("{\"kind\": \"surface\", \"source\": ", text(l.source), ", \"pose\": ", write(l.pose),
             ", \"colour\": ", vec({l.colour.r, l.colour.g, l.colour.b}),
             ", \"opacity\": ", number(l.opacity), "}");
}
std::string write(const CustomLayer& l) { return l.json; }

CustomLayer readCustom(const nlohmann::json& value, const std::string& path, std::string canonical) {
  const ObjectReader layer(value, path);
  CustomLayer l;
  l.kind = kindAt(value, path);
  l.version = 1;
  if (value.contains("version"))
    l.version = static_cast<int>(layer.integer("version", 1, std::numeric_limits<int>::max()));
  l.json = std::move(canonical);
  return l;
}

}  // namespace

std::string writeScene(const Scene& scene) {
  std::string layers;
  for (const Layer& layer : scene.layers)
    layers +=
        cat(layers.empty() ? "\n    " : ",\n    ", std::visit([](const auto& l) { return write(l); }, layer));
  return cat("{\n  \"schema\": ", std::to_string(kSceneSchema), ",\n  \"camera\": ", write(scene.camera),
             ",\n  \"background\": ", vec({scene.background.r, scene.background.g, scene.background.b}),
             scene.lights.empty() ? "" : cat(",\n  \"lights\": ", write(scene.lights)),
             scene.crop ? cat(",\n  \"crop\": ", write(*scene.crop)) : "",
             scene.clip.empty() ? "" : cat(",\n  \"clip\": ", write(scene.clip)), ",\n  \"layers\": [",
             layers, scene.layers.empty() ? "]\n}\n" : "\n  ]\n}\n");
}

Result<Scene> parseScene(std::string_view json) {
  if (json.starts_with("\xEF\xBB\xBF")) json.remove_prefix(3);  // a byte order mark is no part of the text
  return parsedScene<Scene>([&] {
    const nlohmann::json document = parseJson(json);
    const ObjectReader top(document, "");
    checkSchema(top);
    Scene scene;
    if (top.has("camera")) scene.camera = readCamera(top.child("camera"), "/camera");
    if (top.has("background")) scene.background = readRgb(top, "background");
    if (top.has("lights")) scene.lights = readLights(top.child("lights"), "/lights");
    if (top.has("crop")) scene.crop = readCrop(top.child("crop"), "/crop");
    if (top.has("clip")) scene.clip = readClip(top.child("clip"), "/clip");
    const nlohmann::json& layers = top.array("layers");
    top.refuseOthers();
    if (layers.size() > kMaxSceneLayers)
      throw JsonFault{"The scene has " + std::to_string(layers.size()) + " layers, at most " +
                          std::to_string(kMaxSceneLayers) + " are read.",
                      "/layers"};
    const std::vector<std::string> texts = elementTexts(json, "layers");
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const std::string path = pointerTo("/layers", i);
      const std::string kind = kindAt(layers[i], path);
      if (kind == "image")
        scene.layers.emplace_back(readImage(layers[i], path));
      else if (kind == "slice")
        scene.layers.emplace_back(readSlice(layers[i], path));
      else if (kind == "curved")
        scene.layers.emplace_back(readCurved(layers[i], path));
      else if (kind == "surface")
        scene.layers.emplace_back(readSurfaceLayer(layers[i], path));
      else if (kind == "projection")
        scene.layers.emplace_back(readProjection(layers[i], path));
      else if (kind == "shells")
        scene.layers.emplace_back(readShells(layers[i], path));
      else if (kind == "volume")
        scene.layers.emplace_back(readVolume(layers[i], path));
      else if (kind == "isosurface")
        scene.layers.emplace_back(readIsosurface(layers[i], path));
      else if (kind == "lens")
        scene.layers.emplace_back(readLens(layers[i], path));
      else
        scene.layers.emplace_back(readCustom(layers[i], path, texts.at(i)));
    }
    return Result<Scene>(std::move(scene));
  });
}

Result<std::vector<PatientPoint>> parsePath(std::string_view json) {
  if (json.starts_with("\xEF\xBB\xBF")) json.remove_prefix(3);
  return parsedScene<std::vector<PatientPoint>>(
      [&] { return Result<std::vector<PatientPoint>>(readPoints(parseJson(json), "")); });
}

Result<CustomLayer> customLayer(std::string_view json) {
  return parsedScene<CustomLayer>([&] {
    const nlohmann::json value = parseJson(json);
    const std::string kind = kindAt(value, "");
    static const std::set<std::string> known = {"image",  "slice",  "curved",     "surface", "projection",
                                                "shells", "volume", "isosurface", "lens"};
    if (known.contains(kind))
      throw JsonFault{"The kind '" + kind + "' is known and cannot be a custom layer.", "/kind"};
    return Result<CustomLayer>(readCustom(value, "", withoutSpace(json)));
  });
}

std::optional<std::string> sourceOf(const CustomLayer& layer) {
  const nlohmann::json value = nlohmann::json::parse(layer.json, nullptr, false);
  const auto source = value.is_object() ? value.find("source") : value.end();
  if (source == value.end() || !source->is_string()) return std::nullopt;
  return source->get<std::string>();
}

}  // namespace vernier
