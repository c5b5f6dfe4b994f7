// SPDX-License-Identifier: GPL-3.0-or-later
#include "StackGeometry.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "vernier/base/Units.h"

namespace vernier {
namespace {

std::string number(double v, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, v);
  return text;
}
bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool sameDirections(const FramePlane& a, const FramePlane& b) {
  return a.rowDirection == b.rowDirection && a.columnDirection == b.columnDirection;
}

// Directions of the stack: those of its slices, averaged when they differ within the tolerance of one stack.
FramePlane directionsOf(const std::vector<FramePlane>& planes) {
  if (std::all_of(planes.begin(), planes.end(),
                  [&](const FramePlane& p) { return sameDirections(p, planes[0]); }))
    return planes[0];
  glm::dvec3 row{0}, column{0};
  for (const FramePlane& p : planes) {
    row += p.rowDirection.v;
    column += p.columnDirection.v;
  }
  return orthonormalPlane({0, 0, 0}, glm::normalize(row), glm::normalize(column)).value_or(planes[0]);
}

struct Steps {
  std::vector<double> all;
  double median = 0, min = 0, max = 0;
};
Steps stepsOf(const std::vector<double>& positions) {
  Steps s;
  for (std::size_t k = 1; k < positions.size(); ++k) s.all.push_back(positions[k] - positions[k - 1]);
  if (s.all.empty()) return s;
  s.median = median(s.all);
  s.min = *std::min_element(s.all.begin(), s.all.end());
  s.max = *std::max_element(s.all.begin(), s.all.end());
  return s;
}

void refuse3d(Stack& stack, std::string code, std::string why,
              std::map<std::string, FindingValue> numbers = {}) {
  if (stack.why2d.empty()) stack.why2d = why;
  stack.volume3d = false;
  stack.findings.push_back({std::move(code), Severity::Refusal, std::move(why), std::move(numbers)});
}

// Largest distance of an origin from the line; along the normal only, or in space.
double deviation(const std::vector<glm::dvec3>& origins, const std::vector<double>& places,
                 const EvenLine& line, const glm::dvec3* along) {
  double e = 0;
  for (std::size_t k = 0; k < origins.size(); ++k) {
    const glm::dvec3 d = origins[k] - (line.first + places[k] * line.step);
    e = std::max(e, along ? std::abs(glm::dot(d, *along)) : glm::length(d));
  }
  return e;
}

void reportGaps(const std::vector<std::int64_t>& gaps, const Steps& steps, Stack& stack) {
  for (const std::int64_t g : gaps) {
    const auto k = static_cast<std::size_t>(g);
    const double z1 = stack.positions_mm[k], z2 = stack.positions_mm[k + 1];
    const double missing = std::max(1.0, std::round(steps.all[k] / steps.median) - 1);
    stack.findings.push_back({"gap",
                              Severity::Warning,
                              number(missing, 0) + (missing == 1 ? " slice is" : " slices are") +
                                  " missing between " + number(z1, 1) + " and " + number(z2, 1) +
                                  " mm along the normal; nothing is interpolated there.",
                              {{"at_mm", std::vector<double>{z1, z2}},
                               {"step_mm", steps.all[k]},
                               {"after_slice", static_cast<double>(k)},
                               {"missing_slices", missing}}});
  }
}

void setTruePlaces(const std::vector<glm::dvec3>& origins, GridGeometry& grid) {
  const VoxelFromPatient voxelFromPatient = grid.patientFromVoxel.inverse();
  grid.sliceOrigin_vox.clear();
  for (const glm::dvec3& o : origins) grid.sliceOrigin_vox.push_back((voxelFromPatient * PatientPoint(o)).p);
}

bool usableSpacing(glm::dvec2 s) {
  const auto ok = [](double v) { return v >= kMinSpacing_mm && v <= kMaxSpacing_mm; };
  return ok(s.x) && ok(s.y);
}

void reportTilt(Stack& stack, const EvenLine& line, const FramePlane& d, const glm::dvec3& normal) {
  const double step = glm::dot(line.step, normal);
  const auto along = [&](const glm::dvec3& axis) {
    return Degrees(Radians(std::atan2(glm::dot(line.step, axis), step))).deg;
  };
  stack.findings.push_back(
      {"tilt",
       Severity::Warning,
       "Gantry tilt " + number(stack.shear_deg, 1) +
           " degrees, from the image positions; the slices are placed where they were acquired.",
       {{"shear_deg", stack.shear_deg},
        {"along_row_axis_deg", along(d.rowDirection.v)},
        {"along_column_axis_deg", along(d.columnDirection.v)},
        {"step_along_normal_mm", step},
        {"distance_between_origins_mm", glm::length(line.step)}}});
}

void reportUneven(Stack& stack, const Steps& steps, bool changesPlaces) {
  if (!changesPlaces && stack.deviationAlongNormal_mm <= 1e-3 && steps.max - steps.min <= 2e-3) return;
  stack.findings.push_back(
      {"uneven-spacing",
       changesPlaces ? Severity::Warning : Severity::Info,
       changesPlaces ? "The slices are not evenly spaced (up to " + number(stack.deviation_mm, 3) +
                           " mm off a straight even line); each is sampled at its true position."
                     : "The slices are up to " + number(stack.deviation_mm, 3) +
                           " mm off a straight even line, which is harmless; the fitted line is used.",
       {{"step_min_mm", steps.min},
        {"step_median_mm", steps.median},
        {"step_max_mm", steps.max},
        {"max_deviation_from_uniform_grid_mm", stack.deviationAlongNormal_mm},
        {"max_deviation_of_origins_mm", stack.deviation_mm}}});
}

// Places on the line: 0, 1, 2..., a gap counting as the steps that it is long.
std::vector<double> placesOf(const Steps& steps, const std::vector<std::int64_t>& gaps) {
  std::vector<double> places{0};
  for (std::size_t k = 0; k < steps.all.size(); ++k) {
    const bool gap = std::binary_search(gaps.begin(), gaps.end(), static_cast<std::int64_t>(k));
    places.push_back(places.back() + (gap ? steps.all[k] / steps.median : 1.0));
  }
  return places;
}

}  // namespace

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  const std::size_t n = v.size();
  return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

std::optional<FramePlane> orthonormalPlane(const glm::dvec3& position, const glm::dvec3& row,
                                           const glm::dvec3& column) {
  if (!finite(position) || !finite(row) || !finite(column)) return std::nullopt;
  const double lr = glm::length(row), lc = glm::length(column);
  if (!(lr > 1e-6) || !(lc > 1e-6) || !(lr < 1e6) || !(lc < 1e6)) return std::nullopt;
  const glm::dvec3 r = row / lr;
  const glm::dvec3 rest = column / lc - glm::dot(column / lc, r) * r;
  if (glm::length(rest) < 1e-3) return std::nullopt;
  return FramePlane{PatientPoint(position), PatientVec(r), PatientVec(glm::normalize(rest))};
}

EvenLine fitLine(const std::vector<glm::dvec3>& origins, const std::vector<double>& places) {
  const double n = static_cast<double>(origins.size());
  const double mean = std::accumulate(places.begin(), places.end(), 0.0) / n;
  // Around the first origin, so that a stack far from the coordinates' origin loses nothing.
  glm::dvec3 centre{0}, slope{0};
  double spread = 0;
  for (const glm::dvec3& o : origins) centre += (o - origins[0]) / n;
  for (std::size_t k = 0; k < origins.size(); ++k) {
    slope += (places[k] - mean) * (origins[k] - origins[0] - centre);
    spread += (places[k] - mean) * (places[k] - mean);
  }
  if (spread > 0) slope /= spread;
  return {origins[0] + centre - mean * slope, slope};
}

std::vector<std::size_t> orderAlongNormal(const std::vector<SlicePlane>& slices) {
  std::vector<std::size_t> order(slices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (slices.empty()) return order;
  const PatientVec normal = cross(slices[0].plane.rowDirection, slices[0].plane.columnDirection);
  const auto at = [&](std::size_t i) { return glm::dot(slices[i].plane.origin.p, normal.v); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (at(a) != at(b)) return at(a) < at(b);
    return slices[a].tie < slices[b].tie;
  });
  return order;
}

void fitGeometry(const std::vector<FramePlane>& planes, std::int64_t rows, std::int64_t columns,
                 glm::dvec2 spacing_mm, Stack& stack) {
  stack.shape = StackShape::NoGeometry;
  stack.volume3d = false;
  if (planes.empty()) return;
  const FramePlane d = directionsOf(planes);
  const glm::dvec3 normal = glm::cross(d.rowDirection.v, d.columnDirection.v);
  std::vector<glm::dvec3> origins;
  for (const FramePlane& p : planes) {
    origins.push_back(p.origin.p);
    stack.positions_mm.push_back(glm::dot(p.origin.p, normal));
  }
  const Steps steps = stepsOf(stack.positions_mm);
  stack.step_mm = steps.median;

  if (!usableSpacing(spacing_mm)) {
    refuse3d(stack, "pixel-spacing-unusable",
             "The pixel spacing is missing or not between 0.0001 and 1000 mm; lengths are in pixels and 3-D "
             "is refused.");
    return;
  }
  GridGeometry& grid = stack.grid;
  grid.columns = columns;
  grid.rows = rows;
  grid.slices = static_cast<std::int64_t>(planes.size());
  grid.patientFromVoxel.linear[0] = d.rowDirection.v * spacing_mm.y;
  grid.patientFromVoxel.linear[1] = d.columnDirection.v * spacing_mm.x;
  grid.patientFromVoxel.linear[2] = normal * spacing_mm.x;  // a single slice has no step; any length will do
  grid.patientFromVoxel.translation = origins[0];
  if (planes.size() == 1) {
    stack.shape = StackShape::Single;
    stack.why2d = "It is a single slice; 3-D needs at least two.";
    return;
  }
  if (steps.min <= kCoincident_mm) {
    std::vector<double> at;
    for (std::size_t k = 0; k < steps.all.size(); ++k)
      if (steps.all[k] <= kCoincident_mm) at.push_back(stack.positions_mm[k]);
    const std::string n = std::to_string(at.size());
    refuse3d(stack, "coincident-positions",
             "Different slices lie at one position (" + n + (at.size() == 1 ? " pair" : " pairs") +
                 "), and no attribute tells them apart; 3-D is refused.",
             {{"at_mm", at}, {"pairs", static_cast<double>(at.size())}});
    return;
  }
  if (!(steps.median >= kMinSpacing_mm && steps.max < 1e6 && steps.median <= kMaxSpacing_mm)) {
    refuse3d(stack, "slice-step-unusable",
             "The slices lie " + number(steps.median, 4) +
                 " mm apart, which is not between 0.0001 and 1000 mm; 3-D is refused.",
             {{"step_mm", steps.median}});
    return;
  }

  for (std::size_t k = 0; k < steps.all.size(); ++k)
    if (steps.all[k] > kGapFactor * steps.median) grid.gapAfter.push_back(static_cast<std::int64_t>(k));
  const std::vector<double> places = placesOf(steps, grid.gapAfter);
  const EvenLine line = fitLine(origins, places);
  stack.deviation_mm = deviation(origins, places, line, nullptr);
  stack.deviationAlongNormal_mm = deviation(origins, places, line, &normal);
  const double step = glm::dot(line.step, normal);
  stack.shear_deg = Degrees(Radians(std::atan2(glm::length(line.step - step * normal), step))).deg;
  const double limit_mm =
      std::min(kUniformOfStep * steps.median, kUniformOfSpacing * std::min(spacing_mm.x, spacing_mm.y));
  const bool onLine = stack.deviation_mm <= limit_mm;

  grid.patientFromVoxel.linear[2] = line.step;
  grid.patientFromVoxel.translation = line.first;
  stack.shape = stack.shear_deg >= kShear_deg ? StackShape::Sheared : StackShape::Uniform;
  if (!grid.gapAfter.empty() || !onLine) {
    stack.shape = StackShape::Uneven;
    setTruePlaces(origins, grid);
  }
  stack.volume3d = true;
  reportGaps(grid.gapAfter, steps, stack);
  if (stack.shear_deg >= kShear_deg && onLine) reportTilt(stack, line, d, normal);
  if (grid.gapAfter.empty() || !onLine) reportUneven(stack, steps, !onLine);
}

}  // namespace vernier
