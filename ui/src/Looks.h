// SPDX-License-Identifier: GPL-3.0-or-later
// Looks through a volume: what the 3-D tile offers for a series, and where it is seen from. Pure.
#pragma once
#include <string>
#include <vector>

#include "SourceFacts.h"
#include "vernier/plan/Scene.h"

namespace vernier::ui {

struct VolumeLook {
  std::string name;    // for the screen
  std::string view;    // a view name of Presets.h
  std::string preset;  // of renderings: a transfer function by name; "": what fits the volume
  friend bool operator==(const VolumeLook&, const VolumeLook&) = default;
};
// What makes sense for the series. Of CT also bone, soft tissue, lung and vessels; of MR vessels. Colours are
// only rendered.
std::vector<VolumeLook> volumeLooks(const SourceFacts&);
// The one to begin with: renderings of CT and of colours, else the maximum.
VolumeLook firstLook(const SourceFacts&);
// A scene that shows the look, with the view's own camera; nullopt where the view cannot be had.
std::optional<Scene> sceneOfLook(const VolumeLook&, const SourceFacts&);
// What a scene shows, "" for scenes that are no such look: "Bone", and "Bone, changed" for one whose transfer
// function was dragged.
std::string nameOfLook(const Scene&, const std::string& view, const SourceFacts&);

struct Direction {
  const char* name;
  double azimuth_deg, elevation_deg;
};
const std::vector<Direction>& directions();  // front, back, left, right, head, feet
Scene seenFrom(Scene, const Direction&);     // upright; zoom and pan stay

}  // namespace vernier::ui
