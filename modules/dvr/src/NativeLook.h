// SPDX-License-Identifier: GPL-3.0-or-later
// What the native techniques of this module share of planning: the volume, the camera, what is kept, tools.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "vernier/native/VolumeRender.h"
#include "vernier/plan/Technique.h"
#include "vernier/plan/Volumetric.h"

namespace vernier::dvr {

struct NativeLook {
  std::shared_ptr<const Volume> volume;
  CameraPicture camera;
  std::vector<HalfSpace> region;
  std::vector<PlacedSurface> tools;
  std::size_t lights = 0;
  double step_mm = 1;
  bool wantValues = false;

  // SceneInvalid with the JSON path, or what keptRegion and cameraPicture say.
  Result<void> take(const std::string& source, const std::string& where, const PlanContext&);
  std::string dumpCamera() const, dumpLights() const, dumpCuts() const;
  Pass pass(std::string name) const;
  double predicted_ms(double ray_ns, double step_ns, const PlanContext&) const;

  // Null for volumes that have none: colour, uneven slices. Shared with other techniques.
  Result<std::shared_ptr<const native::ProjectionBounds>> bounds(DerivedCache&) const;
  Result<native::SurfaceHits> findTools(Images&, std::stop_token) const;
  void allocateValues(Images&) const;
};

// SceneInvalid, with the JSON path, for numbers that are no material.
Result<void> checkMaterial(const Material&, const std::string& where);

std::string number(double);       // for dumps: six digits, the same in every locale
std::string exactNumber(double);  // for keys: every digit

}  // namespace vernier::dvr
