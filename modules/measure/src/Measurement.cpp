// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Measurement.h"

namespace vernier::measure {
namespace {

using Spots = std::vector<Spot*>;

void add(Spots& out, Length& s) { out = {&s.ends[0], &s.ends[1]}; }
void add(Spots& out, Bidirectional& s) {
  out = {&s.longAxis[0], &s.longAxis[1], &s.shortAxis[0], &s.shortAxis[1]};
}
void add(Spots& out, Angle& s) { out = {&s.arms[0], &s.vertex, &s.arms[1]}; }
void add(Spots& out, Cobb& s) { out = {&s.first[0], &s.first[1], &s.second[0], &s.second[1]}; }
void add(Spots& out, RectangleRegion& s) { out = {&s.corners[0], &s.corners[1]}; }
void add(Spots& out, EllipseRegion& s) { out = {&s.corners[0], &s.corners[1]}; }
void add(Spots& out, PolygonRegion& s) {
  for (Spot& p : s.corners) out.push_back(&p);
}
void add(Spots& out, FreehandRegion& s) {
  for (Spot& p : s.outline) out.push_back(&p);
}
void add(Spots& out, ThresholdRegion& s) { out = {&s.seed}; }
void add(Spots& out, Probe& s) { out = {&s.at}; }
void add(Spots& out, PointToSurface& s) { out = {&s.point}; }
void add(Spots&, ToolToVessel&) {}
void add(Spots& out, IsoVolume& s) {
  if (s.seed) out = {&*s.seed};
}
void add(Spots&, ConvexVolume&) {}
void add(Spots&, SurfaceVolume&) {}
void add(Spots& out, Arrow& s) { out = {&s.tip, &s.tail}; }
void add(Spots& out, Text& s) { out = {&s.at}; }

Spots spotsOf(Shape& shape) {
  Spots out;
  std::visit([&](auto& s) { add(out, s); }, shape);
  return out;
}

constexpr const char* kKinds[] = {"length",
                                  "bidirectional",
                                  "angle",
                                  "cobb",
                                  "rectangle",
                                  "ellipse",
                                  "polygon",
                                  "freehand",
                                  "threshold",
                                  "probe",
                                  "point_to_surface",
                                  "tool_to_vessel",
                                  "iso_volume",
                                  "convex_volume",
                                  "surface_volume",
                                  "arrow",
                                  "text"};
static_assert(std::size(kKinds) == std::variant_size_v<Shape>);

}  // namespace

const char* kindOf(const Shape& shape) { return kKinds[shape.index()]; }

std::vector<Spot> handlesOf(const Shape& shape) {
  Shape copy = shape;
  std::vector<Spot> out;
  for (const Spot* p : spotsOf(copy)) out.push_back(*p);
  return out;
}

void setHandle(Shape& shape, std::size_t n, Spot p) {
  const Spots spots = spotsOf(shape);
  VERNIER_ASSERT(n < spots.size());
  *spots[n] = p;
}

}  // namespace vernier::measure
