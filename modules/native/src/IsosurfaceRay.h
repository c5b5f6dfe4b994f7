// SPDX-License-Identifier: GPL-3.0-or-later
// The first place of a ray where the field reaches a level.
#pragma once
#include "ExactField.h"
#include "GeneralSampler.h"
#include "VolumeRay.h"
#include "vernier/native/Isosurface.h"

namespace vernier::native {

struct IsoHit {
  double t_mm = std::numeric_limits<double>::infinity();
  bool atBegin = false;    // the part began inside
  glm::dvec3 gradient{0};  // per voxel, of modality values
  bool found() const { return t_mm < std::numeric_limits<double>::infinity(); }
};

// The least s in [0, 1] with g(s) >= 0, where g(0) < 0; 2: none.
inline double firstReached(const Cubic& g) {
  const double control[3] = {g.c0 + g.c1 / 3, g.c0 + (2 * g.c1 + g.c2) / 3, g.c0 + g.c1 + g.c2 + g.c3};
  if (control[0] < 0 && control[1] < 0 && control[2] < 0) return 2;
  double ends[4] = {0, 1, 1, 1};
  int n = extremaInside(g, ends + 1);
  if (n == 2 && ends[1] > ends[2]) std::swap(ends[1], ends[2]);
  ends[++n] = 1;
  for (int i = 1; i <= n; ++i) {
    if (g.at(ends[i]) < 0) continue;
    double low = ends[i - 1], high = ends[i];  // monotonic between them
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      (g.at(middle) < 0 ? low : high) = middle;
    }
    return high;
  }
  return 2;
}

// A regular grid with data everywhere, in stored values.
template <class T>
class ExactIso {
 public:
  explicit ExactIso(const IsosurfaceJob& job)
      : job_(job), grid_(cellGridOf<T>(*job.volume)), slope_(job.volume->rescaleOf(0).slope) {
    sign_ = slope_ > 0 ? 1 : -1;
    level_ = sign_ * (job.level - job.volume->rescaleOf(0).intercept) / slope_;
    for (int a = 0; a < 3; ++a) last_[a] = static_cast<double>(grid_.last[a]);
  }

  IsoHit first(const VoxelRay& ray, double from, double to, const RayMarks& marks,
               ProjectionWork& work) const {
    IsoHit hit;
    const double length = to - from;
    const CellWalk<T> whole(grid_, ray.at(from), length * ray.direction);
    if (!whole.meetsVolume()) return hit;
    const Steps met = stepsOf(from, to, job_.step_mm, false);
    CellWalk<T> walk = whole;
    marks.eachRun(met.first, met.first + met.count - 1, [&](std::int64_t begin, std::int64_t end) {
      const double a = (static_cast<double>(begin) * job_.step_mm - from) / length;
      const double b = (static_cast<double>(end) * job_.step_mm - from) / length;
      const double t = within(walk, std::max(a, walk.begin()), std::min(b, walk.end()), hit, work);
      if (t > 1) return true;
      hit.t_mm = from + t * length;
      return false;
    });
    if (hit.found()) hit.gradient = gradient(ray.at(hit.t_mm));
    return hit;
  }

 private:
  // Where within [a, b] of the walk the level is first reached; above 1: nowhere.
  double within(CellWalk<T>& walk, double a, double b, IsoHit& hit, ProjectionWork& work) const {
    if (!(a <= b)) return 2;
    for (walk.enter(a);; walk.step()) {
      ++work.cells;
      T stored[8];
      walk.corners(stored);
      if (reaches(stored)) {
        ++work.samples;
        double v[8], f[3], g[3];
        signedCorners(stored, sign_, v);
        for (double& x : v) x -= level_;
        walk.fractions(walk.entry(), f);
        const double length = walk.exit() - walk.entry();
        for (int n = 0; n < 3; ++n) g[n] = length * walk.direction()[n];
        const Cubic cubic = cubicAlong(v, f, g);
        if (cubic.c0 >= 0) {
          hit.atBegin = walk.entry() <= walk.begin();
          return walk.entry();
        }
        if (const double s = firstReached(cubic); s <= 1) return walk.entry() + s * length;
      }
      if (walk.atEnd() || walk.exit() >= b) return 2;
    }
  }

  bool reaches(const T* v) const {
    for (int n = 0; n < 8; ++n)
      if (sign_ * static_cast<double>(v[n]) >= level_) return true;
    return false;
  }

  double field(const glm::dvec3& p) const {
    T v[8];
    double corners[8], f[3];
    const T* data = grid_.data;
    std::int64_t next[3];
    for (int a = 0; a < 3; ++a) {
      const double x = std::clamp(p[a], 0.0, last_[a]);
      const auto cell = std::min(static_cast<std::int64_t>(x), std::max<std::int64_t>(grid_.last[a] - 1, 0));
      f[a] = x - static_cast<double>(cell);
      data += cell * grid_.stride[a];
      next[a] = grid_.last[a] > 0 ? grid_.stride[a] : 0;
    }
    for (int n = 0; n < 8; ++n)
      v[n] = data[(n & 1 ? next[0] : 0) + (n & 2 ? next[1] : 0) + (n & 4 ? next[2] : 0)];
    signedCorners(v, 1, corners);
    return trilinear(corners, f);
  }

  glm::dvec3 gradient(const glm::dvec3& p) const {
    return slope_ * gradientAt([this](const glm::dvec3& q) { return field(q); }, p, 0, last_);
  }

  const IsosurfaceJob& job_;
  CellGrid<T> grid_;
  double slope_, sign_ = 1, level_ = 0;
  glm::dvec3 last_{0};
};

// Any grid: samples, then bisection.
template <class T>
class SampledIso {
 public:
  explicit SampledIso(const IsosurfaceJob& job) : job_(job), sampler_(*job.volume) {
    const GridGeometry& g = job.volume->grid();
    last_ = {static_cast<double>(g.columns - 1), static_cast<double>(g.rows - 1), g.lastPosition_vox()};
  }

  IsoHit first(const VoxelRay& ray, double from, double to, const RayMarks&, ProjectionWork& work) const {
    IsoHit hit;
    const auto value = [&](double t) { return sampler_.linear(ray.at(t), work.samples); };
    const Steps met = stepsOf(from, to, job_.step_mm, false);
    double before = from;
    bool outside = false;  // `before` has data and lies below the level
    for (std::int64_t k = -1; k <= met.count; ++k) {
      const double t =
          k < 0 ? from : std::clamp((static_cast<double>(met.first + k) + 0.5) * job_.step_mm, from, to);
      const double v = value(t);
      if (std::isnan(v)) {
        outside = false;
      } else if (v < job_.level) {
        outside = true;
      } else {
        hit.t_mm = outside ? between(value, before, t) : t;
        hit.atBegin = !outside;
        const glm::dvec3 p = ray.at(hit.t_mm);
        std::uint64_t unused = 0;
        hit.gradient =
            gradientAt([&](const glm::dvec3& q) { return sampler_.linear(q, unused); }, p, v, last_);
        break;
      }
      before = t;
    }
    return hit;
  }

 private:
  template <class Value>
  double between(const Value& value, double low, double high) const {
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (low + high);
      (value(middle) >= job_.level ? high : low) = middle;
    }
    return high;
  }

  const IsosurfaceJob& job_;
  GeneralSampler<T> sampler_;
  glm::dvec3 last_{0};
};

}  // namespace vernier::native
