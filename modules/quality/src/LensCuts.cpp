// SPDX-License-Identifier: GPL-3.0-or-later
#include "LensCuts.h"

#include <algorithm>
#include <cmath>

namespace vernier::quality {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A line that gets nearer to a plane by less than this per mm runs along it, and may lie past it by rounding.
constexpr double kParallel = 1e-12, kSlack_mm = 1e-9;
constexpr double kShortest_mm = 1e-9;

struct Within {
  double from_mm = -kInfinity, to_mm = kInfinity;
  glm::dvec3 fromNormal{0}, toNormal{0};
  bool holds(double t_mm) const { return from_mm <= t_mm && t_mm <= to_mm; }
};

Within within(const ConvexRegion& lens, const PixelRay& line) {
  Within w;
  for (const HalfSpace& h : lens.planes) {
    const double outside = h.distance_mm(PatientPoint(line.origin)),
                 slope = glm::dot(h.normal.v, line.direction);
    if (std::abs(slope) <= kParallel) {
      if (outside > kSlack_mm) return {kInfinity, -kInfinity, {}, {}};
    } else if (slope < 0) {
      if (-outside / slope > w.from_mm) w.from_mm = -outside / slope, w.fromNormal = h.normal.v;
    } else if (-outside / slope < w.to_mm) {
      w.to_mm = -outside / slope, w.toNormal = h.normal.v;
    }
  }
  return w;
}

struct Cut {
  double t_mm = 0;
  glm::dvec3 normal{0};
};

}  // namespace

std::vector<LensPart> cutAtLenses(const VolumeRay& ray, const std::vector<PlacedLens>& lenses) {
  std::vector<LensPart> parts;
  if (!(ray.begin_mm < ray.end_mm)) return parts;
  std::vector<Within> inside;
  std::vector<Cut> cuts;
  const auto cutAt = [&](double t_mm, glm::dvec3 normal) {
    if (t_mm > ray.begin_mm + kShortest_mm && t_mm < ray.end_mm - kShortest_mm)
      cuts.push_back({t_mm, normal});
  };
  for (const PlacedLens& lens : lenses) {
    inside.push_back(within(*lens.region, ray.line));
    const Within& w = inside.back();
    if (!(w.from_mm < w.to_mm)) continue;
    cutAt(w.from_mm, w.fromNormal), cutAt(w.to_mm, w.toNormal);
  }
  std::sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.t_mm < b.t_mm; });
  LensPart next{ray.begin_mm, ray.end_mm, 0, ray.begunBy, Border::Lens, ray.beginNormal};
  const auto add = [&](double end_mm) {
    next.end_mm = end_mm, next.appearance = 0;
    for (std::size_t n = inside.size(); n > 0 && next.appearance == 0; --n)
      if (inside[n - 1].holds(0.5 * (next.begin_mm + end_mm))) next.appearance = n;
    if (!parts.empty() && parts.back().appearance == next.appearance)
      parts.back().end_mm = end_mm;
    else
      parts.push_back(next);
  };
  for (const Cut& cut : cuts) {
    if (cut.t_mm - next.begin_mm <= kShortest_mm) continue;
    add(cut.t_mm);
    next.begin_mm = cut.t_mm, next.begunBy = Border::Lens, next.beginNormal = cut.normal;
  }
  add(ray.end_mm);
  parts.back().endedBy = ray.endedBy;
  return parts;
}

VolumeRay partOf(const VolumeRay& ray, const LensPart& part) {
  VolumeRay out = ray;
  out.begin_mm = part.begin_mm, out.end_mm = part.end_mm;
  out.begunBy = part.begunBy, out.endedBy = part.endedBy, out.beginNormal = part.beginNormal;
  return out;
}

VolumeRay bareBetween(const VolumeRay& part, double from_mm, double to_mm) {
  VolumeRay out;
  out.line = part.line;
  out.begin_mm = from_mm, out.end_mm = to_mm;
  out.begunBy = from_mm > part.begin_mm ? Border::Tool : part.begunBy;
  out.endedBy = to_mm < part.end_mm ? Border::Tool : part.endedBy;
  out.beginNormal = part.beginNormal;
  out.beginsOpen = part.beginsOpen || from_mm > part.begin_mm;
  out.endsOpen = part.endsOpen || to_mm < part.end_mm;
  out.through = {1};
  return out;
}

}  // namespace vernier::quality
