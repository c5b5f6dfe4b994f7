// SPDX-License-Identifier: GPL-3.0-or-later
#include "Solids.h"

#include <algorithm>
#include <cmath>

#include "vernier/base/Random.h"

namespace vernier::phantoms {
namespace {

struct Interval {
  double low, high;
  bool empty() const { return !(low <= high); }
  void cut(double a, double b) {
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
};

// |p + t d| <= h along one axis.
void cutSlab(Interval& t, double p, double d, double h) {
  if (d == 0.0) {
    if (std::fabs(p) > h) t.high = t.low - 1.0;
  } else {
    t.cut((-h - p) / d, (h - p) / d);
  }
}
// a t^2 + 2 b t + c <= 0, a >= 0.
void cutQuadric(Interval& t, double a, double b, double c) {
  if (a == 0.0) {
    if (c > 0.0) t.high = t.low - 1.0;
    return;
  }
  const double disc = b * b - a * c;
  if (disc < 0.0) {
    t.high = t.low - 1.0;
    return;
  }
  const double root = std::sqrt(disc);
  t.cut((-b - root) / a, (-b + root) / a);
}

// Semi-axes of the local box that holds the shape.
glm::dvec3 halfExtent(const Solid& s) {
  if (s.shape != Shape::Capsule) return s.size_mm;
  const double r = std::max(s.size_mm.x, s.size_mm.y);
  return {r, r, s.size_mm.z + r};
}

// The part of a row inside the shape and its clips, all grown by `margin` (shrunk where negative).
Interval reach(const Solid& s, const RowLine& line, glm::dvec3 p, glm::dvec3 d, double margin) {
  Interval t{0.0, static_cast<double>(line.count - 1)};
  for (const HalfSpace& clip : s.clips) {
    const double slope = glm::dot(clip.normal, line.step_mm);
    const double room = clip.offset_mm + margin - glm::dot(clip.normal, line.start_mm);
    if (slope > 0.0)
      t.high = std::min(t.high, room / slope);
    else if (slope < 0.0)
      t.low = std::max(t.low, room / slope);
    else if (room < 0.0)
      t.high = t.low - 1.0;
  }
  const glm::dvec3 h = halfExtent(s) + glm::dvec3(margin);
  if (!(std::min({h.x, h.y, h.z}) > 0.0)) return {0.0, -1.0};
  if (s.shape == Shape::Ellipsoid) {
    const glm::dvec3 u = p / h, v = d / h;
    cutQuadric(t, glm::dot(v, v), glm::dot(u, v), glm::dot(u, u) - 1.0);
    return t;
  }
  if (s.shape == Shape::Cylinder) {
    const glm::dvec2 u(p.x / h.x, p.y / h.y), v(d.x / h.x, d.y / h.y);
    cutQuadric(t, glm::dot(v, v), glm::dot(u, v), glm::dot(u, u) - 1.0);
  } else {
    cutSlab(t, p.x, d.x, h.x);
    cutSlab(t, p.y, d.y, h.y);
  }
  cutSlab(t, p.z, d.z, h.z);
  return t;
}

// Distance to an axis-aligned ellipse or ellipsoid, first order at the surface; exact when all axes are
// equal.
double ellipticDistance(glm::dvec3 u, glm::dvec3 w) {
  const double k0 = std::sqrt(glm::dot(u, u)), k1 = std::sqrt(glm::dot(w, w));
  return k1 > 0.0 ? k0 * (k0 - 1.0) / k1 : -1e30;
}

double shapeDistance(const Solid& s, glm::dvec3 p) {
  const glm::dvec3 r = s.size_mm;
  switch (s.shape) {
    case Shape::Ellipsoid: {
      const glm::dvec3 u = p / r;
      // The formula's limit in the centre is minus infinity only for its first-order form; the true depth is
      // at most the smallest semi-axis.
      return std::max(ellipticDistance(u, u / r), -std::min({r.x, r.y, r.z}));
    }
    case Shape::Box:
      return std::max({std::fabs(p.x) - r.x, std::fabs(p.y) - r.y, std::fabs(p.z) - r.z});
    case Shape::Cylinder: {
      const glm::dvec3 u(p.x / r.x, p.y / r.y, 0.0), w(u.x / r.x, u.y / r.y, 0.0);
      return std::max({ellipticDistance(u, w), -std::min(r.x, r.y), std::fabs(p.z) - r.z});
    }
    case Shape::Capsule: {
      const double z = std::clamp(p.z, -r.z, r.z);
      const double radius = r.x + (r.y - r.x) * (r.z > 0.0 ? (z + r.z) / (2.0 * r.z) : 0.5);
      return std::sqrt(p.x * p.x + p.y * p.y + (p.z - z) * (p.z - z)) - radius;
    }
  }
  return 1e30;
}

std::uint64_t cellHash(std::uint64_t seed, double x, double y, double z) {
  const auto n = [](double v) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(v) + (1 << 20));
  };
  return randomBits(seed, n(x) | (n(y) << 21) | (n(z) << 42));
}

}  // namespace

double SmoothNoise::at(glm::dvec3 p) {
  const glm::dvec3 c(std::floor(p.x), std::floor(p.y), std::floor(p.z));
  if (c != cell_) {
    cell_ = c;
    for (int n = 0; n < 8; ++n) {
      const std::uint64_t bits = cellHash(seed_, c.x + (n & 1), c.y + ((n >> 1) & 1), c.z + (n >> 2));
      corner_[n] = static_cast<double>(static_cast<std::int64_t>(bits >> 11)) * 0x1.0p-52 - 1.0;
    }
  }
  const glm::dvec3 f = p - c, s = f * f * (glm::dvec3(3.0) - 2.0 * f);
  const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
  const double low = mix(mix(corner_[0], corner_[1], s.x), mix(corner_[2], corner_[3], s.x), s.y);
  const double high = mix(mix(corner_[4], corner_[5], s.x), mix(corner_[6], corner_[7], s.x), s.y);
  return mix(low, high, s.z);
}

AxisBox boundsOf(const Solid& s, double edge_mm) {
  const glm::dvec3 h = halfExtent(s) + glm::dvec3(edge_mm);
  glm::dvec3 reachOf(0.0);
  for (int c = 0; c < 3; ++c) reachOf += glm::abs(s.patientFromLocal[c]) * h[c];
  AxisBox box{s.centre_mm - reachOf, s.centre_mm + reachOf};
  for (const HalfSpace& clip :
       s.clips) {  // axis-aligned clips shorten the box, the others are left to the distance
    for (int c = 0; c < 3; ++c) {
      if (clip.normal[c] == 1.0) box.high[c] = std::min(box.high[c], clip.offset_mm + edge_mm);
      if (clip.normal[c] == -1.0) box.low[c] = std::max(box.low[c], -clip.offset_mm - edge_mm);
    }
  }
  return box;
}

double signedDistance(const Solid& s, glm::dvec3 p_mm) {
  double d = shapeDistance(s, glm::transpose(s.patientFromLocal) * (p_mm - s.centre_mm));
  for (const HalfSpace& clip : s.clips) d = std::max(d, glm::dot(clip.normal, p_mm) - clip.offset_mm);
  return d;
}

FillValue fillAt(const Solid& s, glm::dvec3 p_mm, Texture& texture) {
  switch (s.fill) {
    case Fill::Constant:
      return {s.value};
    case Fill::Speckle: {
      const glm::dvec3 c = glm::floor(p_mm / s.cell_mm);
      return {cellHash(texture.seed, c.x, c.y, c.z) & 1 ? s.value : s.value2};
    }
    case Fill::Folds: {
      // Two octaves; the sheet where they cross zero is a fold, with soft banks.
      const double n = texture.coarse.at(p_mm / s.cell_mm) + 0.5 * texture.fine.at(p_mm / (0.5 * s.cell_mm));
      const double bank = std::clamp(std::fabs(n) / s.threshold, 0.0, 1.0);
      if (s.sheetsOnly) return {s.value2, 1.0 - bank * bank};
      return {s.value2 + (s.value - s.value2) * bank * bank};
    }
    case Fill::Blobs:
      return {s.value + s.value2 * texture.coarse.at(p_mm / s.cell_mm)};
    case Fill::Combs: {
      const glm::dvec3 p = glm::transpose(s.patientFromLocal) * (p_mm - s.centre_mm);
      // Position along the comb: arc length on the ellipse's mean radius, by the diamond angle (no atan2
      // needed).
      const double a = p.x / s.size_mm.x, b = p.y / s.size_mm.y, sum = std::fabs(a) + std::fabs(b);
      const double turn = sum > 0.0 ? a / sum : 0.0;
      const double along =
          turn * 0.5 * 3.14159265358979323846 * 0.5 * (s.size_mm.x + s.size_mm.y) / s.cell_mm;
      return {along - std::floor(along) < s.threshold ? s.value : s.value2};
    }
  }
  return {s.value};
}

void paintRow(const Solid& s, const RowLine& line, double edge_mm, std::uint64_t seed,
              std::span<double> value, std::span<double> noise) {
  const glm::dmat3 localFromPatient = glm::transpose(s.patientFromLocal);
  const glm::dvec3 p0 = localFromPatient * (line.start_mm - s.centre_mm), d = localFromPatient * line.step_mm;
  // An ellipsoid grown by m along its axes is a little smaller than the body at distance m: twice the edge is
  // ample.
  const Interval outer = reach(s, line, p0, d, edge_mm + 1e-6);
  if (outer.empty()) return;
  // Well inside, coverage is 1 and needs no distance. (A capsule's box says nothing about its inside.)
  Interval inner = s.shape == Shape::Capsule ? Interval{0.0, -1.0} : reach(s, line, p0, d, -edge_mm - 1e-6);
  Texture texture(seed);
  const auto first = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(outer.low)));
  const auto last = std::min<std::int64_t>(line.count - 1, static_cast<std::int64_t>(std::ceil(outer.high)));
  for (std::int64_t i = first; i <= last; ++i) {
    const auto x = static_cast<double>(i);
    const glm::dvec3 p = line.start_mm + x * line.step_mm;
    double cover = 1.0;
    if (!(x >= inner.low && x <= inner.high)) {
      double distance = shapeDistance(s, p0 + x * d);
      for (const HalfSpace& clip : s.clips)
        distance = std::max(distance, glm::dot(clip.normal, p) - clip.offset_mm);
      cover = edge_mm > 0.0 ? std::clamp(0.5 - distance / edge_mm, 0.0, 1.0) : (distance <= 0.0 ? 1.0 : 0.0);
      if (cover <= 0.0) continue;
    }
    double target = s.value;
    if (s.fill != Fill::Constant) {
      const FillValue fill = fillAt(s, p, texture);
      target = fill.value;
      cover *= fill.weight;
    }
    double& v = value[static_cast<std::size_t>(i)];
    double& n = noise[static_cast<std::size_t>(i)];
    if (s.maximum) {
      v = std::max(v, cover * target);
    } else {
      v += cover * (target - v);
      n += cover * (s.noise - n);
    }
  }
}

}  // namespace vernier::phantoms
