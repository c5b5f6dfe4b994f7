// SPDX-License-Identifier: GPL-3.0-or-later
#include "SurfaceOptions.h"

#include <algorithm>
#include <filesystem>

#include "vernier/volume/SurfaceFile.h"

namespace vernier::app {
namespace {

// Options that a picture of surfaces alone has no use for.
Result<void> nothingElse(const ViewOptions& o) {
  const std::pair<const char*, bool> given[] = {{"--series", !o.series.empty()},
                                                {"--plane", !o.plane.empty()},
                                                {"--slice", o.slice.has_value()},
                                                {"--slab", o.slab_mm.has_value()},
                                                {"--slab-mode", !o.slabMode.empty()},
                                                {"--interpolation", !o.interpolation.empty()},
                                                {"--window", !o.window.empty()},
                                                {"--preset", !o.preset.empty()},
                                                {"--path", !o.path.empty()},
                                                {"--lens", !o.lens.lenses.empty()},
                                                {"--lens-inner", !o.lens.inner.empty()}};
  for (const auto& [option, isGiven] : given)
    if (isGiven)
      return makeError(ErrorCode::OptionInvalid, "It is of no use to a picture of surfaces alone.", option);
  return {};
}

// The surface that a layer is, or that is its lens's shape.
const std::string* surfaceOf(const Layer& layer) {
  if (const auto* surface = std::get_if<SurfaceLayer>(&layer)) return &surface->source;
  const auto* lens = std::get_if<LensLayer>(&layer);
  const auto* mesh = lens ? std::get_if<MeshShape>(&lens->shape) : nullptr;
  return mesh ? &mesh->source : nullptr;
}

bool shows(const Scene& scene, const std::string& name) {
  return std::any_of(scene.layers.begin(), scene.layers.end(), [&](const Layer& l) {
    const auto* surface = std::get_if<SurfaceLayer>(&l);
    return surface && surface->source == name;
  });
}

}  // namespace

bool onlySurfaces(const ViewOptions& o) {
  return std::all_of(o.inputs.begin(), o.inputs.end(),
                     [](const std::string& p) { return looksLikeSurface(p); });
}

Result<std::vector<std::string>> addSurfaces(Session& session, const ViewOptions& o, std::stop_token stop) {
  std::vector<std::string> files = o.surfaces, names;
  if (onlySurfaces(o)) files.insert(files.begin(), o.inputs.begin(), o.inputs.end());
  for (const std::string& file : files) {
    const Result<std::string> name = session.addSurface(file, stop);
    if (!name) return name.error();
    names.push_back(*name);
  }
  return names;
}

Result<void> findSurfaces(Session& session, const Scene& scene, const std::string& sceneFile,
                          std::stop_token stop) {
  for (const Layer& layer : scene.layers) {
    const std::string* source = surfaceOf(layer);
    if (!source || session.surface(*source)) continue;
    const std::filesystem::path named(*source);
    const bool up = std::any_of(named.begin(), named.end(), [](const auto& part) { return part == ".."; });
    if (named.empty() || named.is_absolute() || up)
      return makeError(
          ErrorCode::SceneInvalid,
          "The source of a surface is the name of a file beside the scene, or of one given by --surface.",
          "/layers");
    const std::string path = (std::filesystem::path(sceneFile).parent_path() / named).string();
    if (const Result<void> added = session.addSurface(*source, path, stop); !added) return added;
  }
  return {};
}

void addSurfaceLayers(Scene& scene, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (shows(scene, name)) continue;
    SurfaceLayer layer;
    layer.source = name;
    scene.layers.emplace_back(std::move(layer));
  }
}

Result<Scene> sceneOfSurfaces(const ViewOptions& o, const std::vector<std::string>& names) {
  if (const Result<void> ok = nothingElse(o); !ok) return ok.error();
  const Result<Camera> camera = parseCamera(o.camera);
  if (!camera) return camera.error();
  Scene scene;
  scene.camera = *camera;
  addSurfaceLayers(scene, names);
  return scene;
}

}  // namespace vernier::app
