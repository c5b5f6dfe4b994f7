// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/native/Shells.h"
#include "vernier/volume/Sampling.h"

namespace vernier::native {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A cut that lies on the volume's border within this cuts nothing: the shells are closed there already.
constexpr double kOnBorder_mm = 1e-6;

struct Bounds {
  double from = -kInfinity, to = kInfinity;
  double fromCosine = 1, toCosine = 1;
  void take(const HalfSpace& h, const PatientRay& ray) {
    const double outside = h.distance_mm(ray.origin), slope = dot(h.normal, ray.direction);
    if (slope > 0) {
      if (const double t = -outside / slope; t < to) to = t, toCosine = slope;
    } else if (slope < 0) {
      if (const double t = -outside / slope; t > from) from = t, fromCosine = -slope;
    } else if (outside > 0) {
      from = kInfinity, to = -kInfinity;
    }
  }
};

ShellRay::Cap capAt(const ShellsJob& job, const PatientRay& ray, double t_mm, double cosine) {
  const std::optional<double> value = sampleModality(*job.volume, ray.at(t_mm));
  if (!value) return {};
  const auto above = std::upper_bound(job.shells.begin(), job.shells.end(), *value,
                                      [](double v, const Shell& s) { return v < s.level; });
  return {static_cast<int>(above - job.shells.begin()) - 1, t_mm, cosine};
}

// Between the ray and the face of a lens at one of its points.
double cosineAt(const ShellsJob& job, const PatientRay& ray, double t_mm) {
  double nearest = kInfinity, cosine = 1;
  for (const auto& lens : job.lenses) {
    const HalfSpace* outermost = nullptr;
    double most = -kInfinity;
    for (const HalfSpace& h : lens->planes)
      if (const double d = h.distance_mm(ray.at(t_mm)); d > most) most = d, outermost = &h;
    if (!outermost || !(std::abs(most) < nearest)) continue;
    nearest = std::abs(most);
    cosine = std::abs(dot(outermost->normal, ray.direction));
  }
  return cosine;
}

}  // namespace

bool isCut(const ShellsJob& job) {
  if (job.kept.size() > kBoxPlanes) return true;
  const GridGeometry& g = job.volume->grid();
  for (int n = 0; n < 8; ++n) {
    const double depth = dot(g.corner(n) - job.camera.eye, job.camera.forward);
    if (!(depth > 0) || depth < job.camera.near_mm) return true;
  }
  return false;
}

ShellRay shellRay(const ShellsJob& job, double x, double y) {
  const PatientRay ray = job.camera.ray(x, y);
  Bounds box, cut;
  for (std::size_t n = 0; n < job.kept.size(); ++n) (n < kBoxPlanes ? box : cut).take(job.kept[n], ray);
  const double perDepth = job.camera.rayPerDepth(x, y), near_mm = job.camera.near_mm * perDepth;
  if (near_mm > cut.from || cut.from < 0) {
    cut.from = std::max({cut.from, near_mm, 0.0});
    if (cut.from == near_mm || cut.from == 0) cut.fromCosine = 1 / perDepth;
  }
  ShellRay out;
  out.from_mm = cut.from, out.to_mm = cut.to;
  const bool cutBegin = cut.from > box.from + kOnBorder_mm, cutEnd = cut.to < box.to - kOnBorder_mm;
  if (!cutBegin) out.from_mm = -kInfinity;
  if (!cutEnd) out.to_mm = kInfinity;
  if (!(std::max(cut.from, box.from) <= std::min(cut.to, box.to))) return out;
  if (cutBegin) out.caps[0] = capAt(job, ray, cut.from, cut.fromCosine);
  if (cutEnd) out.caps[1] = capAt(job, ray, cut.to, cut.toCosine);
  return out;
}

ShellRay shellRay(const ShellsJob& job, double x, double y, std::span<const RaySegment> segments,
                  std::size_t index) {
  const RaySegment& s = segments[index];
  const PatientRay ray = job.camera.ray(x, y);
  ShellRay out = shellRay(job, x, y);
  // Tools open nothing, nor do faces through which the shells go on.
  const auto goesOn = [&](const RaySegment& other) {
    const auto n = static_cast<std::size_t>(other.appearance);
    return other.appearance < 0 || (n < job.goesOn.size() && job.goesOn[n]);
  };
  const auto cap = [&](double t_mm) {
    return capAt(job, ray, t_mm, job.mode == ShellsMode::Lit ? cosineAt(job, ray, t_mm) : 1);
  };
  const double from = static_cast<double>(s.from_mm), to = static_cast<double>(s.to_mm);
  if (s.beginsInside) {
    out.from_mm = from;
    out.caps[0] = index > 0 && goesOn(segments[index - 1]) ? ShellRay::Cap{} : cap(from);
  }
  if (s.endsInside) {
    out.to_mm = to;
    out.caps[1] = index + 1 < segments.size() && goesOn(segments[index + 1]) ? ShellRay::Cap{} : cap(to);
  }
  return out;
}

}  // namespace vernier::native
