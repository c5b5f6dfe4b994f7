// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes as text, written by hand: the order of keys and the shape of numbers are ours to keep.
#pragma once
#include <cmath>
#include <string>

#include "JsonText.h"
#include "Numbers.h"
#include "vernier/plan/Scene.h"

namespace vernier {

template <class... Parts>
std::string cat(const Parts&... parts) {
  std::string out;
  ((out += parts), ...);
  return out;
}

inline std::string number(double x) {
  if (!std::isfinite(x)) return "null";
  if (x == 0 && std::signbit(x)) return "-0.0";  // "-0" would come back as the integer 0
  return shortest(x);
}
inline std::string text(const std::string& s) {
  return nlohmann::json(s).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}
inline const char* flag(bool b) { return b ? "true" : "false"; }
inline std::string vec(glm::dvec3 v) {
  return cat("[", number(v.x), ", ", number(v.y), ", ", number(v.z), "]");
}

std::string write(const VoiWindow&);
std::string write(const ProjectionLayer&);  // this one and those below: SceneVolumes.cpp
std::string write(const ShellsLayer&);
std::string write(const CropBox&);
std::string write(const std::vector<HalfSpace>&);
std::string write(const VolumeLayer&);  // this one and those below: SceneRendering.cpp
std::string write(const IsosurfaceLayer&);
std::string write(const TransferFunction&);
std::string write(const std::vector<Light>&);
std::string write(const PatientFromMesh&);  // the 4 x 4 matrix, row by row: SceneJson.cpp
std::string write(const LensLayer&);        // SceneLens.cpp

}  // namespace vernier
