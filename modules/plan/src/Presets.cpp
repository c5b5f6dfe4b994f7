// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Presets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "vernier/plan/CameraPicture.h"
#include "vernier/plan/LensEdits.h"
#include "vernier/plan/LinkedViews.h"

namespace vernier {
namespace {

struct ViewName {
  const char* name;
  const char* plugin;
};
constexpr ViewName kViews[] = {
    {"stack", "mpr"},
    {"axial", "mpr"},
    {"coronal", "mpr"},
    {"sagittal", "mpr"},
    {"oblique", "mpr"},
    {"slab", "mpr"},
    {"curved", "mpr"},
    {"mip", "angiography"},
    {"minip", "angiography"},
    {"sum", "angiography"},
    {"mean", "angiography"},
    {"shells", "angiography"},
    {"shells-sum", "angiography"},
    {"shells-lit", "angiography"},
    {"attenuation", "angiography"},
    {"dvr", "dvr"},
    {"dvr-shaded", "dvr"},
    {"iso", "dvr"},
    {"lens", "lens"},
};

glm::dvec3 sliceCentre_vox(const GridGeometry& grid, int axis, std::int64_t index) {
  glm::dvec3 c{0.5 * static_cast<double>(grid.columns - 1), 0.5 * static_cast<double>(grid.rows - 1),
               0.5 * (grid.firstPosition_vox() + grid.lastPosition_vox())};
  if (axis == 2 && !grid.even()) {
    const glm::dvec3& origin = grid.sliceOrigin_vox[static_cast<std::size_t>(index)];
    return {c.x + origin.x, c.y + origin.y, origin.z};
  }
  c[axis] = static_cast<double>(index);
  return c;
}

Result<Scene> curvedScene(const std::string& source, const PresetOptions& options) {
  if (!options.curved)
    return makeError(ErrorCode::OptionInvalid, "The view 'curved' needs a path of points in the patient.",
                     "path");
  if (options.slice || options.plane)
    return makeError(ErrorCode::OptionInvalid,
                     "The view 'curved' follows a path; it has no slice number and no plane.",
                     options.slice ? "slice" : "plane");
  CurvedLayer layer = *options.curved;
  layer.source = source;
  layer.slab = options.slab.value_or(Slab{});
  layer.interpolation = options.interpolation;
  layer.window = options.window;
  Scene scene;
  scene.camera = options.camera;
  scene.layers.emplace_back(std::move(layer));
  return scene;
}

// The views through a volume have a camera and no plane.
Result<void> noPlane(const std::string& view, const PresetOptions& options) {
  const std::pair<const char*, bool> given[] = {{"slice", options.slice.has_value()},
                                                {"plane", options.plane.has_value()},
                                                {"slab", options.slab.has_value()},
                                                {"path", options.curved.has_value()}};
  for (const auto& [what, isGiven] : given)
    if (isGiven)
      return makeError(ErrorCode::OptionInvalid,
                       "The view '" + view + "' looks through the whole volume; turn it with a camera.",
                       what);
  if (options.interpolation == Interpolation::Cubic)
    return makeError(ErrorCode::OptionInvalid,
                     "The view '" + view + "' interpolates with nearest or linear; cubic is for slices.",
                     "interpolation");
  return {};
}

const std::map<std::string, ProjectionMode>& projections() {
  static const std::map<std::string, ProjectionMode> modes = {{"mip", ProjectionMode::Max},
                                                              {"minip", ProjectionMode::Min},
                                                              {"sum", ProjectionMode::Sum},
                                                              {"mean", ProjectionMode::Mean},
                                                              {"attenuation", ProjectionMode::Attenuation}};
  return modes;
}

Result<Scene> throughVolume(const std::string& view, const std::string& source,
                            const PresetOptions& options) {
  if (const Result<void> ok = noPlane(view, options); !ok) return ok.error();
  Scene scene;
  scene.camera = options.camera;
  const bool shells = view.starts_with("shells");
  if (shells ? options.projection.has_value() : options.shells.has_value())
    return makeError(
        ErrorCode::OptionInvalid,
        shells ? "The view '" + view + "' shows shells and takes no cue or gain of projections."
               : "Levels and brightness of shells belong to the views shells, shells-sum and shells-lit.",
        shells ? "gain" : "levels");
  if (shells) {
    const ShellsLayer own = shellsOfView(view);
    ShellsLayer layer = options.shells.value_or(own);
    layer.source = source;
    layer.mode = own.mode;
    layer.window = options.window;
    scene.layers.emplace_back(std::move(layer));
    return scene;
  }
  ProjectionLayer layer = options.projection.value_or(ProjectionLayer{});
  layer.source = source;
  layer.mode = projections().at(view);
  layer.interpolation = options.interpolation;
  layer.window = options.window;
  if (layer.cue > 0 && layer.mode != ProjectionMode::Max)
    return makeError(ErrorCode::OptionInvalid, "A depth cue belongs to the views mip and shells.", "cue");
  const bool gains = layer.mode == ProjectionMode::Sum || layer.mode == ProjectionMode::Attenuation;
  if (layer.gain_perMm && !gains)
    return makeError(ErrorCode::OptionInvalid, "A gain belongs to the views sum and attenuation.", "gain");
  scene.layers.emplace_back(std::move(layer));
  return scene;
}

// dvr, dvr-shaded and iso.
Result<Scene> rendering(const std::string& view, const std::string& source, const PresetOptions& options) {
  if (const Result<void> ok = noPlane(view, options); !ok) return ok.error();
  if (options.projection || options.shells)
    return makeError(ErrorCode::OptionInvalid,
                     "Levels, cue and gain belong to the views of projections and shells, such as mip.",
                     "levels");
  if (options.window)
    return makeError(
        ErrorCode::OptionInvalid,
        "The view '" + view + "' has no window: " +
            (view == "iso" ? "it shows one level." : "a transfer function says how values look."),
        "window");
  Scene scene;
  scene.camera = options.camera;
  scene.lights = options.lights;
  if (view == "iso") {
    if (options.volume)
      return makeError(ErrorCode::OptionInvalid,
                       "A transfer function, shading and gains belong to the views dvr and dvr-shaded.",
                       "transfer");
    if (options.interpolation != Interpolation::Linear)
      return makeError(ErrorCode::OptionInvalid, "An iso-surface is of the linear field.", "interpolation");
    IsosurfaceLayer layer = options.iso.value_or(IsosurfaceLayer{});
    layer.source = source;
    scene.layers.emplace_back(std::move(layer));
    return scene;
  }
  if (options.iso) return makeError(ErrorCode::OptionInvalid, "A level belongs to the view iso.", "iso");
  VolumeLayer layer = options.volume.value_or(VolumeLayer{});
  layer.source = source;
  layer.interpolation = options.interpolation;
  if (view == "dvr-shaded" && layer.shading == ShadingModel::None)
    layer.shading = ShadingModel::ColourPerVoxel;
  if (layer.shading == ShadingModel::None && !scene.lights.empty())
    return makeError(ErrorCode::OptionInvalid, "Lights belong to the views dvr-shaded and iso.", "light");
  scene.layers.emplace_back(std::move(layer));
  return scene;
}

// The view dvr with a lens in the middle that shows the iso-surface, which in CT is bone.
Result<Scene> lensView(const std::string& source, const GridGeometry& grid, const PresetOptions& options) {
  Result<Scene> scene = rendering("dvr", source, options);
  if (!scene) return scene;
  const CameraBox box = cameraBox(grid);
  LensLayer lens =
      lensAt(LensPreset::Bone, scene->layers.at(0), box.centre, kLensViewRadius * box.diagonal_mm);
  return addLens(*std::move(scene), std::move(lens));
}

}  // namespace

double longestEdge_mm(const GridGeometry& grid) {
  const glm::dmat3& m = grid.patientFromVoxel.linear;
  const double edge = std::max({glm::length(m[0]) * static_cast<double>(grid.columns - 1),
                                glm::length(m[1]) * static_cast<double>(grid.rows - 1),
                                glm::length(m[2]) * (grid.lastPosition_vox() - grid.firstPosition_vox())});
  return edge > 0 ? edge : std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])});
}

const std::vector<std::string>& viewNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> v;
    for (const ViewName& view : kViews) v.emplace_back(view.name);
    return v;
  }();
  return names;
}

std::string pluginOfView(const std::string& viewName) {
  for (const ViewName& view : kViews)
    if (viewName == view.name) return view.plugin;
  return "";
}

Plane obliquePlane(const GridGeometry& grid) {
  const double a = 30 * std::numbers::pi / 180, e = 20 * std::numbers::pi / 180;
  const double sa = std::sin(a), ca = std::cos(a), se = std::sin(e), ce = std::cos(e);
  return {grid.centre(), PatientVec(sa * ce, -ca * ce, se), PatientVec(-sa * se, ca * se, ce)};
}

SliceAxis sliceAxis(const GridGeometry& grid, PatientVec normal) {
  const std::int64_t counts[] = {grid.columns, grid.rows, grid.slices};
  SliceAxis best;
  double closest = -1;
  for (int axis : {2, 1, 0}) {
    const double c = std::abs(glm::dot(glm::normalize(grid.patientFromVoxel.linear[axis]), normal.v));
    if (c > closest + 1e-9 * glm::length(normal.v)) {
      closest = c;
      best = {axis, counts[axis]};
    }
  }
  return best;
}

PatientPoint slicePoint(const GridGeometry& grid, PatientVec normal, std::int64_t index) {
  const int axis = sliceAxis(grid, normal).axis;
  const PatientPoint onSlice = grid.patientFromVoxel * VoxelPoint(sliceCentre_vox(grid, axis, index));
  // In a sheared or oblique volume the slice's centre wanders sideways; the view must not.
  const glm::dvec3 n = glm::normalize(normal.v);
  const glm::dvec3 fromCentre = onSlice.p - grid.centre().p;
  const glm::dvec3 sideways = fromCentre - n * glm::dot(fromCentre, n);
  if (glm::length(sideways) <= 1e-9 * (1 + glm::length(fromCentre)))
    return onSlice;  // exactly on voxel centres
  return PatientPoint(onSlice.p - sideways);
}

ShellsLayer shellsOfView(const std::string& viewName) {
  ShellsLayer layer;
  if (viewName == "shells-sum") layer.mode = ShellsMode::Sum, layer.b = 1.0 / layer.count;
  if (viewName == "shells-lit") layer.mode = ShellsMode::Lit, layer.count = 3;
  return layer;
}

Result<Scene> presetScene(const std::string& viewName, const std::string& source, const GridGeometry& grid,
                          const PresetOptions& options) {
  static const std::map<std::string, PatientPlane> patientPlanes = {{"axial", PatientPlane::Axial},
                                                                    {"coronal", PatientPlane::Coronal},
                                                                    {"sagittal", PatientPlane::Sagittal}};
  const std::string plugin = pluginOfView(viewName);
  if (plugin.empty())
    return makeError(
        ErrorCode::SceneInvalid,
        "There is no view called '" + viewName +
            "'; views are: stack, axial, coronal, sagittal, oblique, slab, curved, mip, minip, "
            "sum, mean, attenuation, shells, shells-sum, shells-lit, dvr, dvr-shaded, iso, lens.");
  const bool renders = plugin == "dvr" || plugin == "lens";
  if (!renders && (options.volume || options.iso || !options.lights.empty()))
    return makeError(ErrorCode::OptionInvalid,
                     "Transfer functions, levels of surfaces and lights belong to the views dvr, dvr-shaded, "
                     "iso and lens.",
                     options.iso      ? "iso"
                     : options.volume ? "transfer"
                                      : "light");
  if (plugin == "angiography") return throughVolume(viewName, source, options);
  if (plugin == "dvr") return rendering(viewName, source, options);
  if (plugin == "lens") return lensView(source, grid, options);
  if (plugin != "mpr")
    return makeError(ErrorCode::NotBuiltYet,
                     "The view '" + viewName + "' comes with the plugin " + plugin +
                         ", which is not built yet; use axial, coronal, sagittal, oblique, slab or mip.");
  if (viewName == "stack")
    return makeError(ErrorCode::SceneInvalid,
                     "The view 'stack' shows stored frames and is not made from a volume.");

  if (options.shells || options.projection)
    return makeError(ErrorCode::OptionInvalid,
                     "Levels, cue and gain belong to the views through a volume, such as mip and shells.",
                     "levels");
  if (viewName == "curved") return curvedScene(source, options);
  if (options.curved)
    return makeError(ErrorCode::OptionInvalid, "A path belongs to the view 'curved'.", "path");

  SliceLayer layer;
  layer.source = source;
  layer.interpolation = options.interpolation;
  layer.window = options.window;
  Scene scene;
  scene.camera = options.camera;
  if (const auto found = patientPlanes.find(viewName); found != patientPlanes.end()) {
    layer.plane = patientPlane(found->second, {});
    const SliceAxis axis = sliceAxis(grid, layer.plane.normal);
    const std::int64_t index = options.slice.value_or(axis.count / 2);
    if (index < 0 || index >= axis.count)
      return makeError(ErrorCode::OptionInvalid,
                       "Slice " + std::to_string(index) + " does not exist: the volume has slices 0 to " +
                           std::to_string(axis.count - 1) + " in this view.",
                       "slice");
    layer.plane.point = slicePoint(grid, layer.plane.normal, index);
  } else {
    if (options.slice)
      return makeError(ErrorCode::OptionInvalid,
                       "The view '" + viewName + "' has no slice numbers; give it a plane.", "slice");
    layer.plane = obliquePlane(grid);
    if (!scene.camera.height_mm) scene.camera.height_mm = longestEdge_mm(grid);
    if (viewName == "slab") layer.slab = Slab{kPresetSlab_mm, SlabMode::Max};
  }
  if (options.plane && options.slice)
    return makeError(ErrorCode::OptionInvalid,
                     "A plane and a slice number were both given; give one of them.", "slice");
  if (options.plane) layer.plane = *options.plane;
  if (options.slab) layer.slab = *options.slab;
  scene.layers.emplace_back(std::move(layer));
  return scene;
}

Scene stackScene(const std::string& source, std::int64_t index, const PresetOptions& options) {
  ImageLayer layer;
  layer.source = source;
  layer.index = index;
  layer.window = options.window;
  layer.interpolation = options.interpolation;
  Scene scene;
  scene.camera = options.camera;
  scene.layers.emplace_back(std::move(layer));
  return scene;
}

}  // namespace vernier
