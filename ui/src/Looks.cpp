// SPDX-License-Identifier: GPL-3.0-or-later
#include "Looks.h"

#include <algorithm>

#include "SceneEdits.h"
#include "vernier/plan/CameraPicture.h"
#include "vernier/plan/Presets.h"

namespace vernier::ui {
namespace {

// Height of the picture, of the box's diagonal: all of it would leave the patient small, and its corners are
// air.
constexpr double kHeight = 0.75;
// Of the longest edge: what is long is never cut off.
constexpr double kMargin = 1.05;

}  // namespace

std::vector<VolumeLook> volumeLooks(const SourceFacts& f) {
  if (f.colour) return {{"Colours", "dvr", ""}};
  std::vector<VolumeLook> looks{{"MIP", "mip", ""}, {"MinIP", "minip", ""}, {"Mean", "mean", ""}};
  if (f.modality == "CT") {
    looks.insert(looks.end(), {{"Bone", "dvr-shaded", "ct-bone"},
                               {"Soft tissue", "dvr-shaded", "ct-soft"},
                               {"Lung", "dvr-shaded", "ct-lung"},
                               {"Vessels", "dvr-shaded", "ct-angio"}});
  } else if (f.modality == "MR") {
    looks.insert(looks.end(), {{"Volume", "dvr-shaded", "mr"}, {"Vessels", "dvr-shaded", "mr-angio"}});
  } else {
    looks.push_back({"Volume", "dvr-shaded", ""});
  }
  looks.push_back({"Surface", "iso", ""});
  looks.push_back({"Emission shells", "shells", ""});
  return looks;
}

VolumeLook firstLook(const SourceFacts& f) {
  const std::vector<VolumeLook> looks = volumeLooks(f);
  const auto bone =
      std::find_if(looks.begin(), looks.end(), [](const VolumeLook& l) { return l.name == "Bone"; });
  return bone == looks.end() ? looks.front() : *bone;
}

std::optional<Scene> sceneOfLook(const VolumeLook& look, const SourceFacts& f) {
  if (!f.grid) return std::nullopt;
  PresetOptions options;
  if (!look.preset.empty()) {
    options.volume.emplace();
    options.volume->preset = look.preset;
  }
  Result<Scene> scene = presetScene(look.view, f.id.name, *f.grid, options);
  if (!scene) return std::nullopt;
  scene->camera.height_mm =
      std::max(kHeight * cameraBox(*f.grid).diagonal_mm, kMargin * longestEdge_mm(*f.grid));
  return std::move(*scene);
}

std::string nameOfLook(const Scene& scene, const std::string& view, const SourceFacts& f) {
  const Layer* layer = lookOf(scene);
  if (!layer) return "";
  const auto* volume = std::get_if<VolumeLayer>(layer);
  const std::string preset = volume ? volume->preset : "";
  for (const VolumeLook& look : volumeLooks(f))
    if (look.view == view && look.preset == preset)
      return look.name + (volume && volume->transfer ? ", changed" : "");
  return view;
}

const std::vector<Direction>& directions() {
  static const std::vector<Direction> all{{"Front", 0, 0},   {"Back", 180, 0}, {"Left", 90, 0},
                                          {"Right", -90, 0}, {"Head", 0, 90},  {"Feet", 0, -90}};
  return all;
}

Scene seenFrom(Scene scene, const Direction& d) {
  scene.camera.azimuth_deg = d.azimuth_deg, scene.camera.elevation_deg = d.elevation_deg;
  scene.camera.roll_deg = 0;
  return scene;
}

}  // namespace vernier::ui
