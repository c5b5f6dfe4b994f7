// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/LensEdits.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "LensedPlan.h"

namespace vernier {
namespace {

const VoiWindow kBoneWindow{400, 1800, VoiFunction::Linear, "bone"};

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Error fault(std::size_t layer, const char* key, std::string why) {
  return makeError(ErrorCode::SceneInvalid, std::move(why), "/layers/" + std::to_string(layer) + key);
}

Result<LensLayer*> lensOf(Scene& scene, std::size_t layer) {
  LensLayer* lens = layer < scene.layers.size() ? std::get_if<LensLayer>(&scene.layers[layer]) : nullptr;
  if (!lens) return fault(layer, "", "There is no lens in this place of the scene.");
  return lens;
}

// The pose after `linear` was applied in the patient about the lens's middle, which then moves by `by`.
Result<Scene> posed(Scene scene, std::size_t layer, const glm::dmat3& linear, const glm::dvec3& by) {
  Result<LensLayer*> lens = lensOf(scene, layer);
  if (!lens) return lens.error();
  PatientFromMesh& pose = (*lens)->pose;
  const glm::dvec3 middle = middleOf(**lens).p;
  pose.translation = linear * (pose.translation - middle) + middle + by;
  pose.linear = linear * pose.linear;
  if (const Result<void> ok = checkPose(pose); !ok) return fault(layer, "/pose", ok.error().sentence);
  return scene;
}

struct MiddleOfShape {
  MeshPoint operator()(const BoxShape& b) const { return b.centre; }
  MeshPoint operator()(const SphereShape& s) const { return s.centre; }
  MeshPoint operator()(const ConeShape& c) const { return MeshPoint(0.5 * (c.from.p + c.to.p)); }
  MeshPoint operator()(const HullShape& h) const {
    if (h.points.empty()) return {};
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const MeshPoint& p : h.points) low = glm::min(low, p.p), high = glm::max(high, p.p);
    return MeshPoint(0.5 * (low + high));
  }
  MeshPoint operator()(const MeshShape&) const { return {}; }
};

std::string sourceOfLayer(const Layer& l) {
  const std::string* s = volumeOf(l);
  return s ? *s : "";
}

template <class L>
L looking(const Layer& behind) {
  L l;
  l.source = sourceOfLayer(behind);
  return l;
}

}  // namespace

LensInner lensInner(LensPreset preset, const Layer& behind) {
  if (preset == LensPreset::CutOut) return CutOut{};
  if (std::holds_alternative<SliceLayer>(behind)) return SliceLook{Interpolation::Linear, kBoneWindow, false};
  if (preset == LensPreset::Vessels) return looking<ProjectionLayer>(behind);
  return looking<IsosurfaceLayer>(behind);
}

LensInner defaultLensInner(const Layer& behind, bool hounsfield) {
  if (std::holds_alternative<SliceLayer>(behind))
    return hounsfield ? lensInner(LensPreset::Bone, behind)
                      : LensInner(SliceLook{Interpolation::Linear, std::nullopt, true});
  if (std::holds_alternative<VolumeLayer>(behind)) return lensInner(LensPreset::Bone, behind);
  if (std::holds_alternative<IsosurfaceLayer>(behind)) return lensInner(LensPreset::Vessels, behind);
  return looking<VolumeLayer>(behind);
}

LensLayer lensAt(LensPreset preset, const Layer& behind, PatientPoint at, double radius_mm) {
  LensLayer lens;
  lens.shape = SphereShape{{}, radius_mm, 3};
  lens.pose.translation = at.p;
  lens.inner = lensInner(preset, behind);
  return lens;
}

LensLayer trajectoryLens(PatientPoint skin, PatientPoint target, double skinRadius_mm,
                         double targetRadius_mm) {
  // The frame begins at the target, which stays when the entry is moved.
  LensLayer lens;
  lens.shape = ConeShape{MeshPoint(skin.p - target.p), {}, skinRadius_mm, targetRadius_mm, 48};
  lens.pose.translation = target.p;
  return lens;
}

const Layer* layerBehindLens(const Scene& scene) {
  const Layer* slice = nullptr;
  for (const Layer& l : scene.layers) {
    if (looksThroughVolume(l)) return &l;
    if (std::holds_alternative<SliceLayer>(l) && !slice) slice = &l;
  }
  return slice;
}

PatientPoint middleOf(const LensLayer& lens) { return lens.pose * std::visit(MiddleOfShape{}, lens.shape); }

Result<Scene> addLens(Scene scene, LensLayer lens) {
  const std::size_t at = scene.layers.size();
  if (const Result<void> ok = checkPose(lens.pose); !ok) return fault(at, "/pose", ok.error().sentence);
  scene.layers.emplace_back(std::move(lens));
  if (const auto behind = layerBehindLenses(scene); !behind) return behind.error();
  return scene;
}

Result<Scene> removeLens(Scene scene, std::size_t layer) {
  if (const Result<LensLayer*> lens = lensOf(scene, layer); !lens) return lens.error();
  scene.layers.erase(scene.layers.begin() + static_cast<std::ptrdiff_t>(layer));
  return scene;
}

Result<Scene> placeLens(Scene scene, std::size_t layer, PatientPoint middle) {
  const Result<LensLayer*> lens = lensOf(scene, layer);
  if (!lens) return lens.error();
  const PatientVec by = middle - middleOf(**lens);
  return moveLens(std::move(scene), layer, by);
}

Result<Scene> moveLens(Scene scene, std::size_t layer, PatientVec by) {
  if (!finite(by.v)) return fault(layer, "/pose", "A lens moves by a finite number of millimetres.");
  return posed(std::move(scene), layer, glm::dmat3(1), by.v);
}

Result<Scene> dragLens(Scene scene, std::size_t layer, const CameraPicture& c, glm::dvec2 from,
                       glm::dvec2 to) {
  const Result<LensLayer*> lens = lensOf(scene, layer);
  if (!lens) return lens.error();
  const PatientVec across = c.across(to.x, to.y) - c.across(from.x, from.y);
  if (c.projection == Projection::Orthographic) return moveLens(std::move(scene), layer, across);
  const double depth = dot(c.forward, middleOf(**lens) - c.eye);
  if (!(depth > 0)) return fault(layer, "/pose", "The lens is behind the eye, so it cannot be dragged.");
  return moveLens(std::move(scene), layer, across * depth);
}

Result<Scene> turnLens(Scene scene, std::size_t layer, PatientVec axis, double degrees) {
  const double l = length(axis);
  if (!(l > 0) || !std::isfinite(l) || !std::isfinite(degrees))
    return fault(layer, "/pose", "A lens turns about an axis of a length above 0 by a finite angle.");
  const glm::dvec3 u = axis.v / l;
  const double a = degrees * std::numbers::pi / 180, c = std::cos(a), s = std::sin(a);
  glm::dmat3 turn;
  for (int k = 0; k < 3; ++k) {  // Rodrigues' formula
    glm::dvec3 e(0);
    e[k] = 1;
    turn[k] = e * c + glm::cross(u, e) * s + u * (u[k] * (1 - c));
  }
  return posed(std::move(scene), layer, turn, glm::dvec3(0));
}

Result<Scene> scaleLens(Scene scene, std::size_t layer, glm::dvec3 factors) {
  if (!finite(factors) || !(factors.x > 0 && factors.y > 0 && factors.z > 0))
    return fault(layer, "/pose", "A lens is scaled by factors above 0.");
  Result<LensLayer*> lens = lensOf(scene, layer);
  if (!lens) return lens.error();
  // In the lens's own frame, about its middle there.
  PatientFromMesh& pose = (*lens)->pose;
  const glm::dvec3 own = std::visit(MiddleOfShape{}, (*lens)->shape).p;
  pose.translation += pose.linear * (own - factors * own);
  for (int k = 0; k < 3; ++k) pose.linear[k] *= factors[k];
  if (const Result<void> ok = checkPose(pose); !ok) return fault(layer, "/pose", ok.error().sentence);
  return scene;
}

Result<Scene> setLensInner(Scene scene, std::size_t layer, LensInner inner) {
  Result<LensLayer*> lens = lensOf(scene, layer);
  if (!lens) return lens.error();
  (*lens)->inner = std::move(inner);
  return scene;
}

}  // namespace vernier
