// SPDX-License-Identifier: GPL-3.0-or-later
// From options to a Scene.
#include "ViewOptions.h"

#include <algorithm>

#include "LensOptions.h"
#include "OptionText.h"
#include "PresentationOption.h"
#include "RenderingOptions.h"
#include "SurfaceOptions.h"
#include "VolumeOptions.h"
#include "vernier/plan/SceneJson.h"

namespace vernier::app {
namespace {

// A scene says all of this itself; an option that would be ignored is refused.
Result<void> nothingBesideScene(const ViewOptions& o) {
  const std::pair<const char*, bool> given[] = {{"--camera", !o.camera.empty()},
                                                {"--plane", !o.plane.empty()},
                                                {"--slice", o.slice.has_value()},
                                                {"--slab", o.slab_mm.has_value()},
                                                {"--slab-mode", !o.slabMode.empty()},
                                                {"--interpolation", !o.interpolation.empty()},
                                                {"--window", !o.window.empty()},
                                                {"--preset", !o.preset.empty()},
                                                {"--path", !o.path.empty()},
                                                {"--width", o.width_mm.has_value()},
                                                {"--form", !o.form.empty()},
                                                {"--path-up", !o.pathUp.empty()},
                                                {"--presentation", !o.presentation.empty()}};
  for (const auto& [option, isGiven] : given)
    if (isGiven) return invalid(option, "It goes with --view; a scene file says this itself.");
  for (const std::string& option : {givenVolumeOption(o.volume), givenRenderingOption(o.rendering)})
    if (!option.empty()) return invalid(option, "It goes with --view; a scene file says this itself.");
  return {};
}

// Likewise for options that stored frames have no use for.
Result<void> nothingForStacks(const ViewOptions& o) {
  if (!o.plane.empty())
    return invalid("--plane", "The view stack shows stored frames; choose one with --slice.");
  if (o.interpolation == "cubic")
    return invalid("--interpolation",
                   "Stored frames are shown with nearest or linear; cubic is for slices of a volume.");
  if (o.slab_mm || !o.slabMode.empty())
    return invalid("--slab", "The view stack shows stored frames; use axial, coronal, sagittal or oblique.");
  for (const std::string& option : {givenVolumeOption(o.volume), givenRenderingOption(o.rendering)})
    if (!option.empty())
      return invalid(option, "The view stack shows stored frames; use mip, shells or dvr.");
  return {};
}

// A slice is turned by its plane; of the camera it has only the zoom.
Result<void> onlyZoomForFlat(const Scene& scene, const std::string& option) {
  const bool flat = std::any_of(scene.layers.begin(), scene.layers.end(), [](const Layer& l) {
    return std::holds_alternative<SliceLayer>(l) || std::holds_alternative<ImageLayer>(l);
  });
  Camera zoomed;
  zoomed.zoom = scene.camera.zoom;
  if (flat && !(scene.camera == zoomed))
    return invalid("--camera", "'" + option + "': a slice has only a zoom; turn it with --plane.");
  return {};
}

Result<Scene> sceneFromFile(const std::string& path) {
  const Result<std::string> text = textOf(path, "The scene");
  if (!text) return text.error();
  return parseScene(*text);
}

Interpolation interpolationOf(const std::string& name) {
  return name == "nearest" ? Interpolation::Nearest
         : name == "cubic" ? Interpolation::Cubic
                           : Interpolation::Linear;
}

// What --path, --width, --form and --path-up say; they belong to the view curved.
Result<std::optional<CurvedLayer>> curvedFrom(const ViewOptions& o) {
  if (o.view != "curved") {
    for (const auto& [option, given] : {std::pair{"--path", !o.path.empty()},
                                        {"--width", o.width_mm.has_value()},
                                        {"--form", !o.form.empty()},
                                        {"--path-up", !o.pathUp.empty()}})
      if (given) return invalid(option, "It goes with --view curved.");
    return std::optional<CurvedLayer>();
  }
  if (o.path.empty())
    return invalid("--path", "The view curved needs a path: x,y,z;x,y,z;... in patient mm, or a .json file.");
  CurvedLayer layer;
  const Result<std::vector<PatientPoint>> path = parsePathOption(o.path);
  if (!path) return path.error();
  layer.path = *path;
  layer.form = o.form == "stretched" ? CurvedForm::Stretched : CurvedForm::Straightened;
  if (o.width_mm) layer.width_mm = *o.width_mm;
  if (!o.pathUp.empty()) {
    const Result<glm::dvec3> up = vec3("--path-up", "It", split(o.pathUp, ','));
    if (!up)
      return invalid("--path-up", "'" + o.pathUp + "' is no direction; give three numbers, such as 0,0,1.");
    layer.up = PatientVec(*up);
  }
  return std::optional(layer);
}

Result<Scene> sceneFromView(Session& session, const ViewOptions& o, const ProgressFn& progress,
                            std::stop_token stop) {
  PresetOptions p;
  p.slice = o.slice;
  p.interpolation = interpolationOf(o.interpolation);
  Result<std::optional<CurvedLayer>> curved = curvedFrom(o);
  if (!curved) return curved.error();
  p.curved = std::move(*curved);
  if (const Result<void> r = volumeOptions(o.volume, o.view, p); !r) return r.error();
  if (const Result<void> r = renderingOptions(o.rendering, o.view, o.preset, p); !r) return r.error();
  const Result<Camera> camera = parseCamera(o.camera);
  if (!camera) return camera.error();
  p.camera = *camera;
  if (!o.plane.empty()) {
    const Result<Plane> plane = parsePlane(o.plane);
    if (!plane) return plane.error();
    p.plane = *plane;
  }
  if (!o.slab_mm && !o.slabMode.empty() && o.view != "slab")
    return invalid("--slab-mode", "A mode needs a slab: give its thickness with --slab MM.");
  if (o.slab_mm || !o.slabMode.empty())
    p.slab = Slab{o.slab_mm.value_or(kPresetSlab_mm), o.slabMode == "min"    ? SlabMode::Min
                                                      : o.slabMode == "mean" ? SlabMode::Mean
                                                                             : SlabMode::Max};
  if (!o.window.empty()) {
    const Result<VoiWindow> w = parseWindow(o.window);
    if (!w) return w.error();
    p.window = *w;
  }
  const auto withPreset = [&](const std::string& unit) -> Result<void> {
    if (o.preset.empty() || o.view.starts_with("dvr") || o.view == "lens")
      return {};  // there it names a transfer function
    const Result<VoiWindow> w = windowPreset(o.preset, unit);
    if (!w) return w.error();
    p.window = *w;
    return {};
  };
  if (o.view == "stack") {
    if (const Result<void> r = nothingForStacks(o); !r) return r.error();
    const Result<std::int64_t> count = session.imageCount("");
    if (!count) return count.error();
    const std::int64_t index = o.slice.value_or(*count / 2);
    const auto image = session.image("", index);
    if (!image) return image.error();
    if (const Result<void> r = withPreset((*image)->info().unit); !r) return r.error();
    Scene scene = stackScene("", index, p);
    std::get<ImageLayer>(scene.layers.at(0)).presentation = o.presentation;
    return scene;
  }
  if (!o.presentation.empty())
    return invalid("--presentation", "A presentation state is for stored frames; it goes with --view stack.");
  const auto volume = session.volume("", progress, stop);
  if (!volume) return volume.error();
  if (const Result<void> r = withPreset((*volume)->info().unit); !r) return r.error();
  return presetScene(o.view, "", **volume, p);
}

Result<void> knownTechnique(Session& session, const std::string& name) {
  std::string names;
  for (const PluginInfo& p : session.plugins())
    for (const std::string& t : p.techniques) {
      if (t == name) return {};
      names += (names.empty() ? "" : ", ") + t;
    }
  if (name.empty() || names.empty()) return {};  // without any plugin the plan says what is missing
  return invalid("--technique", "No technique is called '" + name + "'; there are " + names + ".");
}

// A presentation state brings its own image: `o` then names its SOP Instance UID and its slice.
Result<void> chooseSeries(Session& session, ViewOptions& o) {
  Result<StackChoice> choice = session.choose(o.series);
  if (!choice) return choice.error();
  if (!o.presentation.empty()) {
    const auto state =
        choosePresentation(session, o.presentation, o.series.empty() ? std::nullopt : std::optional(*choice));
    if (!state) return state.error();
    choice = state->stack;
    o.presentation = state->sopInstanceUid;
    if (!o.slice) o.slice = state->slice;
  }
  session.use(*choice);
  if (o.frame && !choice->volumeFile)
    return invalid("--frame",
                   "It chooses a volume of a 4-D volume file; a DICOM series is chosen with --series.");
  if (o.zSpan && !choice->volumeFile) return invalid("--z-span", "It is said of lists of images.");
  session.readVolumeFilesWith(o.frame, o.zSpan);
  return {};
}

// By --view or --scene.
Result<Scene> sceneOfVolumes(Session& session, const ViewOptions& o, const std::vector<std::string>& surfaces,
                             const ProgressFn& progress, std::stop_token stop) {
  if (o.view.empty() && o.sceneFile.empty())
    return invalid("--view", "Say what to draw with --view or --scene.");
  if (!o.view.empty() && onlySurfaces(o))
    return invalid("--view", "The views are of volumes; leave it out to see the surface.");
  if ((o.view == "stack" || o.view == "curved") && !o.surfaces.empty())
    return invalid("--surface", "The view " + o.view +
                                    " shows no surfaces yet; use axial, coronal, sagittal, oblique or slab.");
  if (!o.sceneFile.empty())
    if (const Result<void> alone = nothingBesideScene(o); !alone) return alone.error();
  Result<Scene> scene = o.sceneFile.empty()   ? sceneFromView(session, o, progress, stop)
                        : o.sceneText.empty() ? sceneFromFile(o.sceneFile)
                                              : parseScene(o.sceneText);
  if (!scene) return scene;
  // What the scene itself shows of the surfaces that were given is left as it has it.
  addSurfaceLayers(*scene, surfaces);
  if (const Result<void> r = addLenses(session, *scene, o, progress, stop); !r) return r.error();
  if (!o.camera.empty())
    if (const Result<void> flat = onlyZoomForFlat(*scene, o.camera); !flat) return flat.error();
  if (const Result<void> found = findSurfaces(session, *scene, o.sceneFile, stop); !found)
    return found.error();
  return scene;
}

}  // namespace

Result<RenderRequest> makeRequest(Session& session, const ViewOptions& given, const Settings& settings,
                                  const ProgressFn& progress, std::stop_token stop) {
  RenderRequest r;
  ViewOptions o = given;
  const Result<glm::ivec2> size = parseSize(o.size);
  if (!size) return size.error();
  r.view.width_px = size->x;
  r.view.height_px = size->y;
  const Result<std::vector<std::string>> surfaces = addSurfaces(session, o, stop);
  if (!surfaces) return surfaces.error();
  const bool alone = o.view.empty() && o.sceneFile.empty() && !surfaces->empty();
  if (!onlySurfaces(o) && !alone)
    if (const Result<void> chosen = chooseSeries(session, o); !chosen) return chosen.error();
  session.bridgeGaps(o.bridge);
  if (const Result<void> known = knownTechnique(session, o.technique); !known) return known.error();
  Result<Scene> scene =
      alone ? sceneOfSurfaces(o, *surfaces) : sceneOfVolumes(session, o, *surfaces, progress, stop);
  if (!scene) return scene.error();
  r.scene = std::move(*scene);
  r.viewName = o.view;
  const std::string engine = o.engine.empty() ? settings.engine : o.engine;
  r.quality.engine = engine == "gl"       ? EngineChoice::Gl
                     : engine == "native" ? EngineChoice::Native
                                          : EngineChoice::Auto;
  r.quality.technique = o.technique;
  r.quality.level = o.quality == "draft"       ? QualityLevel::Draft
                    : o.quality == "reference" ? QualityLevel::Reference
                                               : QualityLevel::Review;
  r.quality.step = o.step.value_or(1.0);
  r.quality.maxError = o.maxError;
  r.quality.minFps = o.minFps;
  r.options.measure = !o.noError;
  r.options.error.samples = static_cast<std::size_t>(o.errorSamples);
  r.options.error.seed = o.seed;
  r.options.goal = o.maxError;
  return r;
}

}  // namespace vernier::app
