// SPDX-License-Identifier: GPL-3.0-or-later
#include "Lenses.h"

#include <algorithm>
#include <cmath>

#include "Looks.h"
#include "vernier/plan/LensEdits.h"

namespace vernier::ui {
namespace {

// The sphere that is drawn has facets: a plane further out may miss them (8 parts of an icosahedron's edge:
// their middles lie at 0.996).
constexpr double kCuts = 0.995;
constexpr double kLeast_px = 4, kLeast_mm = 0.5, kMost_mm = 500;

LensLook windowed(const WindowChoice& c) {
  return {c.name, SliceLook{Interpolation::Linear, c.window, false}};
}

// One lens over a slice, as the edits want it.
template <class Edit>
LensLayer edited(const LensLayer& lens, Edit&& edit) {
  Scene scene;
  scene.layers = {SliceLayer{}, lens};
  const Result<Scene> after = edit(std::move(scene));
  return after ? std::get<LensLayer>(after->layers[1]) : lens;
}

double sphereRadius_mm(const LensLayer& lens) {
  const auto* sphere = std::get_if<SphereShape>(&lens.shape);
  return sphere ? sphere->radius_mm * glm::length(lens.pose.linear[0]) : 0;
}

}  // namespace

std::vector<LensLook> lensLooks(const WindowFacts& facts) {
  std::vector<LensLook> all;
  const LensLook inverted{"Inverted", SliceLook{Interpolation::Linear, std::nullopt, true}};
  if (facts.unit == "HU") {
    const std::vector<WindowChoice> choices = windowChoices(facts);
    for (const char* name : {"Bone", "Lung", "Brain", "Abdomen"})
      for (const WindowChoice& c : choices)
        if (c.name == name && c.window) all.push_back(windowed(c));
  }
  const bool first = all.empty();
  if (first) all.push_back(inverted);
  if (first)
    for (const WindowChoice& c : windowChoices(facts))
      if (c.window && all.size() < 5) all.push_back(windowed(c));
  if (!first) all.push_back(inverted);
  all.push_back({"Cut out", CutOut{}});
  return all;
}

std::vector<LensLook> lensLooksThrough(const SourceFacts& f, const Scene& around, const std::string& view) {
  std::vector<LensLook> all{{"Cut out", CutOut{}}};
  const std::string shown = nameOfLook(around, view, f);
  for (const VolumeLook& look : volumeLooks(f)) {
    const std::optional<Scene> scene = look.name == shown ? std::nullopt : sceneOfLook(look, f);
    if (!scene) continue;
    const Layer& layer = *lookOf(*scene);
    // A maximum inside stands behind all that is rendered on the ray, so that next to nothing of it would be
    // seen.
    if (const auto* volume = std::get_if<VolumeLayer>(&layer)) all.push_back({look.name, *volume});
    if (const auto* iso = std::get_if<IsosurfaceLayer>(&layer)) all.push_back({look.name, *iso});
  }
  return all;
}

std::optional<Place> facing(const CameraPicture& c, const LensLayer& lens) {
  const double depth = dot(middleOf(lens) - c.eye, c.forward);
  const bool parallel = c.projection == Projection::Orthographic;
  if (!parallel && !(depth > 0)) return std::nullopt;
  const double scale = parallel ? 1 : depth;
  Place p;
  p.inPatient = true;
  p.unit_mm = c.pixelStep * scale;
  p.right = p.unit_mm * c.right, p.down = -p.unit_mm * c.up, p.normal = -1.0 * c.forward;
  p.origin = c.eye + depth * c.forward + scale * c.across(0, 0);
  return p;
}

bool cuts(const Plane& plane, const LensLayer& lens) {
  const double away = dot(middleOf(lens) - plane.point, normalize(plane.normal));
  return std::abs(away) < kCuts * sphereRadius_mm(lens);
}

std::optional<LensDisc> discOf(const LensLayer& lens, const Place& place) {
  if (!std::holds_alternative<SphereShape>(lens.shape) || !place.inPatient) return std::nullopt;
  LensDisc d;
  const PatientPoint middle = middleOf(lens);
  d.centre_px = place.pixelOf(middle);
  d.away_mm = place.distance_mm(middle);
  d.sphere_mm = sphereRadius_mm(lens);
  if (!(std::abs(d.away_mm) < kCuts * d.sphere_mm)) return std::nullopt;
  d.radius_px = std::sqrt(d.sphere_mm * d.sphere_mm - d.away_mm * d.away_mm) / place.unit_mm;
  return d;
}

std::optional<LensPart> partOf(const LensDisc& d, glm::dvec2 px, double grip_px) {
  const double from = glm::length(px - d.centre_px);
  const double within = std::min(grip_px, 0.3 * d.radius_px);  // room to move it, however small it is
  if (from > d.radius_px + grip_px) return std::nullopt;
  return from < d.radius_px - within ? LensPart::Inside : LensPart::Outline;
}

LensLayer movedLens(const LensLayer& lens, const Place& place, glm::dvec2 way) {
  return edited(lens,
                [&](Scene s) { return moveLens(std::move(s), 1, way.x * place.right + way.y * place.down); });
}

LensLayer lensWithRadius(const LensLayer& lens, const Place& place, double radius_px) {
  const std::optional<LensDisc> d = discOf(lens, place);
  if (!d) return lens;
  const double radius_mm = std::max(kLeast_px, radius_px) * place.unit_mm;
  return scaledLens(lens, std::hypot(radius_mm, d->away_mm) / d->sphere_mm);
}

LensLayer scaledLens(const LensLayer& lens, double factor) {
  const double radius = sphereRadius_mm(lens);
  if (!(radius > 0)) return lens;
  const double f = std::clamp(factor * radius, kLeast_mm, kMost_mm) / radius;
  return edited(lens, [&](Scene s) { return scaleLens(std::move(s), 1, glm::dvec3(f)); });
}

}  // namespace vernier::ui
