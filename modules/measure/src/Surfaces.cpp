// SPDX-License-Identifier: GPL-3.0-or-later
// Distances to and between surfaces, and what a closed surface holds.
#include <cmath>

#include "SurfaceDistance.h"
#include "Work.h"
#include "vernier/volume/MeshFacts.h"

namespace vernier::measure {
namespace {

constexpr const char* kOwnAccuracy = "the accuracy of a surface from a file is not known and not included";

std::shared_ptr<const Mesh> meshOf(const Work& w, const SurfaceRef& s) {
  const auto none = [](const char* sentence) {
    return Result<std::shared_ptr<const Mesh>>(makeError(ErrorCode::OptionInvalid, sentence));
  };
  auto mesh = s.level_val ? (w.sources.isoSurface ? w.sources.isoSurface(w.what.on.source, *s.level_val)
                                                  : none("There is no volume to take the surface of."))
                          : (w.sources.surface ? w.sources.surface(s.name)
                                               : none("There are no surfaces to measure to."));
  if (!mesh) throw Refused{mesh.error()};
  if (!*mesh) refuse("No value reaches the level; the surface is empty.");
  return *mesh;
}

PatientFromMesh poseOf(const SurfaceRef& s) {
  if (s.level_val) return {};
  const double d = glm::determinant(s.pose.linear);
  if (!std::isfinite(d) || d == 0)
    refuse("The pose of the surface cannot be used: it is flat or not finite.");
  return s.pose;
}

void distance(Work& w, const Nearest& n, int uncertainPoints) {
  const double size = glm::length(n.b - n.a);
  const double one = size > 0 ? w.quadratic((n.b - n.a) / size) : w.worstVariance();
  w.add("distance", n.distance_mm, w.unit,
        uncertainPoints > 0 ? w.expanded(uncertainPoints * one) : std::nullopt);
  w.out.found = {n.a, n.b};
  if (n.distance_mm == 0) w.note("they touch or pass through each other");
  noteGaps(w, w.out.found);
}

// Of an iso-surface u^2 = sum over patches of one voxel face, (face x spacing)^2 / 12, with faces and spacing
// of a cube as large as a voxel.
std::optional<double> volumeVariance(const Work& w, double area_mm2) {
  const glm::dvec3 s = w.volume->grid().spacing_mm();
  return area_mm2 * std::pow(s.x * s.y * s.z, 4.0 / 3) / 12;
}

}  // namespace

void measureSurfaces(Work& w) {
  if (const auto* s = std::get_if<PointToSurface>(&w.what.shape)) {
    const SurfaceTree tree(*meshOf(w, s->surface), poseOf(s->surface));
    distance(w, tree.nearest(s->point), s->surface.level_val ? 2 : 1);
    if (!s->surface.level_val) w.note(kOwnAccuracy);
  }
  if (const auto* s = std::get_if<ToolToVessel>(&w.what.shape)) {
    const SurfaceTree tool(*meshOf(w, s->tool), poseOf(s->tool)),
        vessel(*meshOf(w, s->vessel), poseOf(s->vessel));
    const Nearest n = tool.nearest(vessel, w.stop);
    if (w.stop.stop_requested()) throw Refused{makeError(ErrorCode::Cancelled, "")};
    distance(w, n, (s->tool.level_val ? 1 : 0) + (s->vessel.level_val ? 1 : 0));
    if (!s->tool.level_val || !s->vessel.level_val) w.note(kOwnAccuracy);
  }
  if (const auto* s = std::get_if<SurfaceVolume>(&w.what.shape)) {
    const std::shared_ptr<const Mesh> mesh = meshOf(w, s->surface);
    const PatientFromMesh pose = poseOf(s->surface);
    const MeshFacts facts = meshFacts(*mesh);
    if (!facts.closed) refuse("The surface is open, so that it encloses no volume.");
    const double scale = std::abs(glm::determinant(pose.linear));
    w.add("volume", std::abs(facts.signedVolume_mm3) * scale, w.unit + "3",
          s->surface.level_val && w.volume ? w.expanded(*volumeVariance(w, facts.area_mm2)) : std::nullopt);
    if (!s->surface.level_val) w.note(kOwnAccuracy);
    if (facts.signedVolume_mm3 < 0) w.note("the surface is turned inside out");
  }
}

}  // namespace vernier::measure
