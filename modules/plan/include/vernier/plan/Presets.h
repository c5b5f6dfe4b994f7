// SPDX-License-Identifier: GPL-3.0-or-later
// View names that expand to a Scene: stack axial coronal sagittal oblique slab. Conventions (CLINICAL 4): axial is seen
// from the feet (patient right on screen left, anterior up), coronal from the front, sagittal from the patient's left
// (anterior on screen left), H up. oblique has the axes right and up of the 3-D camera at azimuth 30, elevation 20 and
// shows a square whose side is the longest edge of the box of voxel centres (as the peer programs do).
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vernier/plan/Scene.h"
#include "vernier/volume/Volume.h"

namespace vernier {

struct PresetOptions {
  std::optional<std::int64_t> slice;      // stack: index; axial..: voxel slice nearest; absent: the middle
  std::optional<Plane> plane;             // replaces the preset's plane
  std::optional<Slab> slab;               // `slab` alone: 10 mm, max
  std::optional<VoiWindow> window;
  Interpolation interpolation = Interpolation::Linear;
  Camera camera;                          // zoom, pan
};

// The view names of the command line, built or not, and which plugin a name needs.
VERNIER_API const std::vector<std::string>& viewNames();

// For a volume (all but `stack`). SceneInvalid for an unknown name, NotBuiltYet for one that a later plugin brings.
VERNIER_API Result<Scene> presetScene(const std::string& viewName, const std::string& source, const Volume&,
                                      const PresetOptions&);
// The `stack` view: needs no geometry.
VERNIER_API Scene stackScene(const std::string& source, std::int64_t index, const PresetOptions&);

}  // namespace vernier
