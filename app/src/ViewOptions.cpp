// SPDX-License-Identifier: GPL-3.0-or-later
#include "ViewOptions.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "OptionChecks.h"
#include "PresentationOption.h"
#include "SurfaceOptions.h"
#include "vernier/plan/LinkedViews.h"
#include "vernier/plan/SceneJson.h"
#include "vernier/volume/Voi.h"

namespace vernier::app {
namespace {

constexpr std::uintmax_t kMaxSceneBytes = std::uintmax_t{16} << 20;

Error invalid(const std::string& option, const std::string& sentence) {
  return makeError(ErrorCode::OptionInvalid, sentence, option);
}

std::vector<std::string> split(const std::string& text, char by) {
  std::vector<std::string> parts;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t end = std::min(text.find(by, at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

std::optional<double> number(const std::string& text) {
  double x = 0;
  const char* end = text.data() + text.size();
  const auto [p, ec] = std::from_chars(text.data(), end, x);
  if (ec != std::errc() || p != end || !std::isfinite(x)) return std::nullopt;
  return x;
}

// "key=1,2,3,other=4": numbers that follow a key belong to it until the next key.
Result<std::vector<std::pair<std::string, std::vector<std::string>>>> keyed(const std::string& option,
                                                                            const std::string& text) {
  std::vector<std::pair<std::string, std::vector<std::string>>> out;
  for (const std::string& part : split(text, ',')) {
    const std::size_t eq = part.find('=');
    if (eq != std::string::npos)
      out.push_back({part.substr(0, eq), {part.substr(eq + 1)}});
    else if (!out.empty())
      out.back().second.push_back(part);
    else
      return invalid(option, "'" + text + "' does not begin with KEY=; --help shows the keys.");
  }
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (out[k].first == out[i].first) return invalid(option, out[i].first + " is given twice.");
  return out;
}

Result<glm::dvec3> vec3(const std::string& option, const std::string& key,
                        const std::vector<std::string>& parts) {
  glm::dvec3 v;
  for (int i = 0; i < 3; ++i) {
    const auto x = parts.size() == 3 ? number(parts[static_cast<std::size_t>(i)]) : std::nullopt;
    if (!x) return invalid(option, key + " needs three numbers, such as " + key + "=0,0,1.");
    v[i] = *x;
  }
  return v;
}

}  // namespace

Result<glm::ivec2> parseSize(const std::string& text) {
  const auto parts = split(text, 'x');
  const auto w = parts.size() == 2 ? number(parts[0]) : std::nullopt;
  const auto h = parts.size() == 2 ? number(parts[1]) : std::nullopt;
  if (!w || !h || *w != std::floor(*w) || *h != std::floor(*h) || *w < 1 || *h < 1 || *w > 16384 ||
      *h > 16384)
    return invalid("--size",
                   "'" + text + "' is not WIDTHxHEIGHT with 1 to 16384 pixels each, such as 512x512.");
  return glm::ivec2(static_cast<int>(*w), static_cast<int>(*h));
}

Result<VoiWindow> parseWindow(const std::string& text) {
  const auto parts = split(text, ',');
  const auto c = parts.size() == 2 ? number(parts[0]) : std::nullopt;
  const auto w = parts.size() == 2 ? number(parts[1]) : std::nullopt;
  if (!c || !w || *w <= 0)
    return invalid("--window", "'" + text + "' is not CENTER,WIDTH with a width above 0, such as 40,400.");
  return normalised(VoiWindow{*c, *w, VoiFunction::Linear, "as given"});
}

Result<VoiWindow> windowPreset(const std::string& name, const std::string& unit) {
  struct Row {
    const char* name;
    double center, width;
  };
  static constexpr Row kRows[] = {{"brain", 40, 80},        {"subdural", 75, 215}, {"stroke", 35, 40},
                                  {"lung", -600, 1500},     {"bone", 400, 1800},   {"abdomen", 50, 400},
                                  {"mediastinum", 50, 350}, {"liver", 100, 150}};
  std::string names;
  for (const Row& r : kRows) {
    if (name == r.name) {
      if (unit != "HU")
        return invalid("--preset",
                       "The preset " + name + " is for CT in HU; these values are '" + unit + "'.");
      return VoiWindow{r.center, r.width, VoiFunction::Linear, r.name};
    }
    names += std::string(names.empty() ? "" : ", ") + r.name;
  }
  return invalid("--preset", "No window preset '" + name + "'; there are " + names + ".");
}

Result<Camera> parseCamera(const std::string& text) {
  Camera c;
  if (text.empty()) return c;
  const auto pairs = keyed("--camera", text);
  if (!pairs) return pairs.error();
  for (const auto& [key, values] : *pairs) {
    if (key == "projection") {
      if (values.size() != 1 || (values[0] != "orthographic" && values[0] != "perspective"))
        return invalid("--camera", "projection is orthographic or perspective.");
      c.projection = values[0] == "perspective" ? Projection::Perspective : Projection::Orthographic;
      continue;
    }
    const auto x = values.size() == 1 ? number(values[0]) : std::nullopt;
    double* target = key == "azimuth"     ? &c.azimuth_deg
                     : key == "elevation" ? &c.elevation_deg
                     : key == "roll"      ? &c.roll_deg
                     : key == "fov"       ? &c.fov_deg
                     : key == "zoom"      ? &c.zoom
                     : key == "near"      ? &c.near_mm
                     : key == "distance"  ? &c.distance_mm.emplace(0)
                                          : nullptr;
    if (!target)
      return invalid("--camera",
                     "No key '" + key + "'; there are azimuth, elevation, roll, projection, fov, zoom, distance and near.");
    if (!x) return invalid("--camera", key + " needs one number.");
    *target = *x;
  }
  if (!(c.near_mm >= 0)) return invalid("--camera", "near is at least 0 mm.");
  if (!(c.zoom > 0 && c.zoom <= 1e4)) return invalid("--camera", "zoom is above 0 and at most 10000.");
  if (!(c.fov_deg > 0 && c.fov_deg < 180))
    return invalid("--camera", "fov is above 0 and below 180 degrees.");
  return c;
}

Result<Plane> parsePlane(const std::string& text) {
  const auto pairs = keyed("--plane", text);
  if (!pairs) return pairs.error();
  std::map<std::string, glm::dvec3> given;
  for (const auto& [key, values] : *pairs) {
    if (key != "point" && key != "normal" && key != "up" && key != "from" && key != "to")
      return invalid("--plane", "No key '" + key + "'; there are point, normal and up, or from, to and up.");
    const Result<glm::dvec3> v = vec3("--plane", key, values);
    if (!v) return v.error();
    if (!given.emplace(key, *v).second) return invalid("--plane", "The key " + key + " was given twice.");
  }
  const auto has = [&](const char* a, const char* b) {
    return given.size() == 3 && given.contains("up") && given.contains(a) && given.contains(b);
  };
  if (has("point", "normal"))
    return Plane{PatientPoint(given["point"]), PatientVec(given["normal"]), PatientVec(given["up"])};
  if (!has("from", "to"))
    return invalid("--plane",
                   "A plane needs point=x,y,z,normal=x,y,z,up=x,y,z or from=x,y,z,to=x,y,z,up=x,y,z in "
                   "patient mm.");
  Result<Plane> plane =
      planeThrough(PatientPoint(given["from"]), PatientPoint(given["to"]), PatientVec(given["up"]));
  if (!plane) return makeError(plane.error().code, plane.error().sentence, "--plane");
  return plane;
}

namespace {

Result<std::string> textOf(const std::string& path, const char* what) {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(path, ec) || std::filesystem::file_size(path, ec) > kMaxSceneBytes)
    return makeError(ErrorCode::FileNotFound,
                     std::string(what) + " is not a readable file of at most 16 MiB.", path);
  std::ifstream f(path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(f)), {});
}

}  // namespace

Result<std::vector<PatientPoint>> parsePathOption(const std::string& text) {
  if (text.ends_with(".json")) {
    const Result<std::string> json = textOf(text, "The path");
    if (!json) return json.error();
    return parsePath(*json);
  }
  std::vector<PatientPoint> points;
  for (const std::string& part : split(text, ';')) {
    const Result<glm::dvec3> p = vec3("--path", "a point", split(part, ','));
    if (!p)
      return invalid("--path",
                     "'" + part + "' is no point; give x,y,z;x,y,z;... in patient mm, or the name of a .json file.");
    points.emplace_back(*p);
  }
  return points;
}

void addViewOptions(CLI::App& sub, ViewOptions& o) {
  sub.add_option("INPUT", o.inputs,
                 "Files, folders or ZIP archives: DICOM, NIfTI, NRRD, MetaImage, VTI, raw, lists of images; or surface "
                 "files alone")
      ->required();
  auto* view = sub.add_option("--view", o.view, "stack axial coronal sagittal oblique slab curved");
  sub.add_option("--scene", o.sceneFile, "Scene as JSON (docs/scene.md)")->excludes(view);
  sub.add_option("--surface", o.surfaces,
                 "A surface file (docs/surfaces.md), mm: an outline on slices, alone in 3-D, or as the scene "
                 "has it (repeatable)");
  sub.add_option("--series", o.series,
                 "Series Instance UID, volume file or number in `vernier info`, #2 for a second stack");
  sub.add_option("--frame", o.frame, "Of a 4-D volume file: which volume, counted from 0");
  sub.add_option("--z-span", o.zSpan, "Of a list of images: length that all slices span, as of the pixel size (mm)")
      ->check(finiteAboveZero());
  sub.add_option("--size", o.size, "Picture, WxH pixels")->capture_default_str();
  sub.add_option("--camera", o.camera,
                 "azimuth=30,elevation=20,projection=orthographic,fov=30,zoom=1,roll=0,distance=400,near=0");
  sub.add_option("--plane", o.plane, "point=x,y,z,normal=x,y,z,up=x,y,z or from=x,y,z,to=x,y,z,up=x,y,z in patient mm");
  sub.add_option("--slice", o.slice, "Slice, counted from 0 along the view's axis (absent: the middle)");
  sub.add_option("--slab", o.slab_mm, "Slab thickness in mm, centred on the plane")
      ->check(finiteFrom(0, 1e5));
  sub.add_option("--slab-mode", o.slabMode, "max min mean (absent: max)")
      ->check(CLI::IsMember({"max", "min", "mean"}));
  sub.add_option("--interpolation", o.interpolation, "nearest linear cubic (absent: linear)")
      ->check(CLI::IsMember({"nearest", "linear", "cubic"}));
  sub.add_option("--path", o.path, "View curved: x,y,z;x,y,z;... in patient mm, or a .json file of such points");
  sub.add_option("--width", o.width_mm, "View curved: width of the sheet in mm (absent: 50)")
      ->check(finiteAboveZero());
  sub.add_option("--form", o.form, "View curved: straightened stretched (absent: straightened)")
      ->check(CLI::IsMember({"straightened", "stretched"}));
  sub.add_option("--path-up", o.pathUp, "View curved: up at the path's beginning (stretched: everywhere), x,y,z");
  auto* window = sub.add_option("--window", o.window, "CENTER,WIDTH in modality values (HU for CT)");
  sub.add_option("--preset", o.preset, "brain subdural stroke lung bone abdomen mediastinum liver")
      ->excludes(window);
  sub.add_option("--presentation", o.presentation,
                 "Presentation state to apply to a stored frame: SOP Instance UID or number in `vernier info`");
  sub.add_option("--engine", o.engine, "auto gl native")->check(CLI::IsMember({"auto", "gl", "native"}));
  sub.add_option("--technique", o.technique, "A technique by name, as in `vernier plugins`");
  sub.add_option("--quality", o.quality, "draft review reference")
      ->check(CLI::IsMember({"draft", "review", "reference"}))
      ->capture_default_str();
  sub.add_option("--max-error", o.maxError,
                 "Largest error wanted, in levels of 255; exit 4 when it is not reached")
      ->check(finiteAboveZero());
  sub.add_option("--min-fps", o.minFps, "Frames per second wanted")->check(finiteAboveZero());
  sub.add_option("--error-samples", o.errorSamples, "Pixels that the error is measured at")
      ->check(CLI::Range(1, 100'000'000))
      ->capture_default_str();
  sub.add_option("--seed", o.seed, "Seed of the error's sample")
      ->check(wholeNumber64())
      ->capture_default_str();
  sub.add_flag("--no-error", o.noError, "Do not measure the error")->excludes("--max-error");
  sub.add_flag("--bridge-gaps", o.bridge, "Interpolate across missing slices; the picture says so");
}

namespace {

// A scene says all of this itself; an option that would be ignored is refused.
Result<void> nothingBesideScene(const ViewOptions& o) {
  const std::pair<const char*, bool> given[] = {
      {"--camera", !o.camera.empty()},      {"--plane", !o.plane.empty()},
      {"--slice", o.slice.has_value()},     {"--slab", o.slab_mm.has_value()},
      {"--slab-mode", !o.slabMode.empty()}, {"--interpolation", !o.interpolation.empty()},
      {"--window", !o.window.empty()},      {"--preset", !o.preset.empty()},
      {"--path", !o.path.empty()},          {"--width", o.width_mm.has_value()},
      {"--form", !o.form.empty()},          {"--path-up", !o.pathUp.empty()},
      {"--presentation", !o.presentation.empty()}};
  for (const auto& [option, isGiven] : given)
    if (isGiven) return invalid(option, "It goes with --view; a scene file says this itself.");
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
    for (const auto& [option, given] : {std::pair{"--path", !o.path.empty()}, {"--width", o.width_mm.has_value()},
                                        {"--form", !o.form.empty()}, {"--path-up", !o.pathUp.empty()}})
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
    if (!up) return invalid("--path-up", "'" + o.pathUp + "' is no direction; give three numbers, such as 0,0,1.");
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
    if (o.preset.empty()) return {};
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
    const auto state = choosePresentation(session, o.presentation,
                                          o.series.empty() ? std::nullopt : std::optional(*choice));
    if (!state) return state.error();
    choice = state->stack;
    o.presentation = state->sopInstanceUid;
    if (!o.slice) o.slice = state->slice;
  }
  session.use(*choice);
  if (o.frame && !choice->volumeFile)
    return invalid("--frame", "It chooses a volume of a 4-D volume file; a DICOM series is chosen with --series.");
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
  Result<Scene> scene =
      o.sceneFile.empty() ? sceneFromView(session, o, progress, stop) : sceneFromFile(o.sceneFile);
  if (!scene) return scene;
  // What the scene itself shows of the surfaces that were given is left as it has it.
  addSurfaceLayers(*scene, surfaces);
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
  r.quality.maxError = o.maxError;
  r.quality.minFps = o.minFps;
  r.options.measure = !o.noError;
  r.options.error.samples = static_cast<std::size_t>(o.errorSamples);
  r.options.error.seed = o.seed;
  r.options.goal = o.maxError;
  return r;
}

}  // namespace vernier::app
