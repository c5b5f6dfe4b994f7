// SPDX-License-Identifier: GPL-3.0-or-later
#include "GridVectors.h"

#include <algorithm>
#include <cmath>

#include "FrameReading.h"

namespace vernier {
namespace {

constexpr Tag kGridFrameOffset = 0x3004000C, kFrameTime = 0x00181063, kFrameTimeVector = 0x00181065;

// One frame per offset along the normal from the plane of the root.
void placeFrames(const std::vector<double>& offsets_mm, Record& record) {
  Instance& i = record.instance;
  std::vector<FrameAttributes> frames(offsets_mm.size(), i);
  record.frameKeys.assign(offsets_mm.size(), record);
  const glm::dvec3 normal = glm::cross(i.plane->rowDirection.v, i.plane->columnDirection.v);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const glm::dvec3 shift = offsets_mm[f] * normal;
    frames[f].plane->origin = PatientPoint(i.plane->origin.p + shift);
    frames[f].filePlane->origin = PatientPoint(i.filePlane->origin.p + shift);
    record.frameKeys[f].rawPlane->position += shift;
  }
  static_cast<FrameAttributes&>(i) = frames.front();
  static_cast<FrameKeys&>(record) = record.frameKeys.front();
  i.frames = std::make_shared<const std::vector<FrameAttributes>>(std::move(frames));
}

void refuse(Record& record, const char* code, std::string why) {
  record.findings.push_back({code,
                             Severity::Refusal,
                             std::move(why) + " The frames have no positions and can be browsed only.",
                             {}});
  record.instance.plane.reset();
  record.instance.filePlane.reset();
  record.rawPlane.reset();
}

bool allFinite(const std::vector<double>& v) {
  return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
}

bool isAxial(const RawPlane& p) {
  return glm::length(p.row - glm::dvec3(1, 0, 0)) <= 1e-6 &&
         glm::length(p.column - glm::dvec3(0, 1, 0)) <= 1e-6;
}

// Offsets from the first plane; nullopt: neither reading of the standard fits (C.8.8.3.2). Zero first:
// relative, along row x column. Equal to the position's z, in an axial grid: patient coordinates.
std::optional<std::vector<double>> doseOffsets(std::vector<double> grid, const RawPlane& plane) {
  if (grid.front() == 0) return grid;
  const double z = plane.position.z;
  if (!isAxial(plane) || std::abs(grid.front() - z) > 1e-3) return std::nullopt;
  const double first = grid.front();
  for (double& g : grid) g -= first;
  return grid;
}

}  // namespace

void readDose(const AttributeReader& root, Record& record) {
  Instance& i = record.instance;
  const auto scaling = root.decimals(0x3004000E);
  setRescale(scaling.empty() ? 0 : scaling[0], 0, i);
  const std::string units = root.code(0x30040002);
  i.unit = i.rescaleInvalid      ? "stored value"
           : units == "GY"       ? "Gy"
           : units == "RELATIVE" ? "relative dose"
                                 : "stored value";
  if (i.framesDeclared == 1) return;
  const auto grid = root.decimals(kGridFrameOffset);
  if (grid.size() != i.framesDeclared)
    return refuse(record, "grid-frame-offsets",
                  "The Grid Frame Offset Vector has " + std::to_string(grid.size()) + " values for " +
                      std::to_string(i.framesDeclared) + " frames.");
  if (!allFinite(grid))
    return refuse(record, "grid-frame-offsets",
                  "The Grid Frame Offset Vector has values that are no numbers.");
  if (!i.plane || !record.rawPlane) return;
  const auto offsets = doseOffsets(grid, *record.rawPlane);
  if (!offsets)
    return refuse(
        record, "grid-frame-offsets",
        "The Grid Frame Offset Vector begins neither with 0 nor, in an axial grid, with the z of the first "
        "plane: where the planes lie is not said.");
  placeFrames(*offsets, record);
}

void readNuclear(const AttributeReader& root, Record& record) {
  Instance& i = record.instance;
  const auto pointers = root.longs(0x00280009);
  const auto vector = [&](Tag t) {
    auto v = root.words(t);
    if (std::find(pointers.begin(), pointers.end(), t) == pointers.end() || v.size() != i.framesDeclared)
      v.clear();
    return v;
  };
  // Image Position and Orientation stand in the detector's item; slices are told from it along the normal.
  if (const auto detector = root.item(0x00540022); detector && !record.rawPlane)
    setPlane(positionOf(detector->decimals(0x00200032)), orientationOf(detector->decimals(0x00200037)), i,
             record);
  const auto slices = vector(0x00540080);
  const auto spacing = root.decimal(0x00180088);
  const bool placed = !slices.empty() && i.plane && spacing && std::isfinite(*spacing) && *spacing != 0;
  if (placed) {
    std::vector<double> offsets;
    for (const std::uint16_t s : slices) offsets.push_back((static_cast<double>(s) - 1) * *spacing);
    placeFrames(offsets, record);
  } else if (i.framesDeclared > 1) {
    i.plane.reset();
    i.filePlane.reset();
    record.rawPlane.reset();
  }
  struct Axis {
    Tag tag;
    const char* name;
    bool time;  // an axis of a cine, unless each of its steps is a volume
  };
  constexpr Axis kAxes[] = {{0x00540010, "energy window", false}, {0x00540020, "detector", false},
                            {0x00540030, "phase", true},          {0x00540050, "rotation", false},
                            {0x00540060, "R-R interval", false},  {0x00540070, "time slot", true},
                            {0x00540100, "time slice", true}};
  std::vector<FrameAttributes> frames(i.frames ? *i.frames
                                               : std::vector<FrameAttributes>(i.framesDeclared, i));
  if (record.frameKeys.empty()) record.frameKeys.assign(i.framesDeclared, record);
  bool differ = placed;
  for (const Axis& axis : kAxes) {
    const auto values = vector(axis.tag);
    if (values.empty() || (axis.time && !placed)) continue;
    if (std::all_of(values.begin(), values.end(), [&](std::uint16_t v) { return v == values[0]; })) continue;
    differ = true;
    for (std::size_t f = 0; f < values.size(); ++f) {
      std::string& text = record.frameKeys[f].gridVectors;
      text += (text.empty() ? "" : ", ") + std::string(axis.name) + " " + std::to_string(values[f]);
    }
  }
  if (!differ) {
    record.frameKeys.clear();
    return;
  }
  static_cast<FrameKeys&>(record) = record.frameKeys.front();
  i.frames = std::make_shared<const std::vector<FrameAttributes>>(std::move(frames));
}

void readFrameTimes(const AttributeReader& root, Record& record) {
  Instance& i = record.instance;
  if (i.framesDeclared < 2) return;
  const auto pointers = root.longs(0x00280009);
  const auto named = [&](Tag t) {
    return pointers.empty() || std::find(pointers.begin(), pointers.end(), t) != pointers.end();
  };
  // The vector holds, for each frame, the time since the one before; its first value is 0 by definition.
  auto steps = named(kFrameTimeVector) ? root.decimals(kFrameTimeVector) : std::vector<double>();
  if (steps.size() != i.framesDeclared) {
    const auto every = named(kFrameTime) ? root.decimal(kFrameTime) : std::nullopt;
    if (!every) return;
    steps.assign(i.framesDeclared, *every);
  }
  steps[0] = 0;
  if (!allFinite(steps) || std::any_of(steps.begin(), steps.end(), [](double s) { return s < 0; })) return;
  double t = 0;
  for (const double s : steps) i.frameTimes_ms.push_back(t += s);
}

}  // namespace vernier
