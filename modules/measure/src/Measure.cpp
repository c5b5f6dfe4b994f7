// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Measure.h"

#include "Work.h"
#include "vernier/base/Guarded.h"

namespace vernier::measure {
namespace {

enum class Room { Lines, Regions, Probe, Surfaces, Volumes, Words };
Room roomOf(const Shape& s) {
  const auto is = [&]<class... K>() { return (std::holds_alternative<K>(s) || ...); };
  if (is.template operator()<Length, Bidirectional, Angle, Cobb>()) return Room::Lines;
  if (is.template
      operator()<RectangleRegion, EllipseRegion, PolygonRegion, FreehandRegion, ThresholdRegion>())
    return Room::Regions;
  if (is.template operator()<measure::Probe>()) return Room::Probe;
  if (is.template operator()<PointToSurface, ToolToVessel, SurfaceVolume>()) return Room::Surfaces;
  if (is.template operator()<IsoVolume, ConvexVolume>()) return Room::Volumes;
  return Room::Words;
}

Measured run(const Measurement& m, const Sources& sources, std::stop_token stop) {
  Work w{m, sources, std::move(stop), {}, {}, {}, glm::dvec3(1), "mm", glm::dmat3(0), true, {}};
  const std::vector<Spot> points = handlesOf(m.shape);
  const Room room = roomOf(m.shape);
  if (m.on.space == Space::Image && (room == Room::Surfaces || room == Room::Volumes))
    refuse("Surfaces and volumes are measured in the patient's space, not in a stored frame.");
  prepare(w, points);
  switch (room) {
    case Room::Lines:
      measureLines(w);
      break;
    case Room::Regions:
      measureRegion(w);
      break;
    case Room::Probe:
      measureProbe(w);
      break;
    case Room::Surfaces:
      measureSurfaces(w);
      break;
    case Room::Volumes:
      measureVolume(w);
      break;
    case Room::Words:
      w.out.notes.clear();
      break;
  }
  return std::move(w.out);
}

}  // namespace

Result<Measured> measure(const Measurement& m, const Sources& sources, std::stop_token stop) {
  return guarded("measure", [&]() -> Result<Measured> {
    try {
      return run(m, sources, std::move(stop));
    } catch (const Refused& r) {
      return r.error;
    }
  });
}

}  // namespace vernier::measure
