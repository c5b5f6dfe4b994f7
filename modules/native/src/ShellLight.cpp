// SPDX-License-Identifier: GPL-3.0-or-later
// The light of lit shells, from the field instead of from the triangles that stand for it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "GeneralSampler.h"
#include "vernier/native/Shells.h"

namespace vernier::native {
namespace {

constexpr double kStep_vox = 0.125;  // of the search for the level
constexpr int kSteps = static_cast<int>(kLitReach_vox / kStep_vox);

// The eight voxels around a place, read once for all places between them; only where each has data.
template <class T>
class Cell {
 public:
  explicit Cell(const Volume& v) : volume_(v), grid_(v.grid()), data_(reinterpret_cast<const T*>(v.data())) {}

  bool holds(const glm::dvec3& p) {
    const glm::dvec3 whole = glm::floor(p);
    if (whole != at_) read(whole);
    return whole_;
  }
  double value(const glm::dvec3& p) const {
    const glm::dvec3 t = p - at_;
    const auto row = [&](int n) { return corner_[n] + t.x * (corner_[n + 1] - corner_[n]); };
    const double low = row(0) + t.y * (row(2) - row(0)), high = row(4) + t.y * (row(6) - row(4));
    return low + t.z * (high - low);
  }
  glm::dvec3 gradient(const glm::dvec3& p) const {
    const glm::dvec3 t = p - at_;
    const auto between = [](double a, double b, double u) { return a + u * (b - a); };
    const auto along = [&](int axis, int other, int third, double u, double v) {
      const auto rise = [&](int n) { return corner_[n + axis] - corner_[n]; };
      return between(between(rise(0), rise(other), u), between(rise(third), rise(other + third), u), v);
    };
    return {along(1, 2, 4, t.y, t.z), along(2, 1, 4, t.x, t.z), along(4, 1, 2, t.x, t.y)};
  }

 private:
  void read(const glm::dvec3& whole) {
    at_ = whole;
    const glm::dvec3 last(grid_.columns - 2, grid_.rows - 2, grid_.slices - 2);
    whole_ = grid_.even() && volume_.info().rescale.size() <= 1 &&
             glm::all(glm::greaterThanEqual(whole, glm::dvec3(0))) &&
             glm::all(glm::lessThanEqual(whole, last));
    if (!whole_) return;
    const ModalityRescale& r = volume_.rescaleOf(0);
    const glm::i64vec3 first(whole);
    for (int n = 0; n < 8; ++n) {
      const std::int64_t i = first.x + (n & 1), j = first.y + (n >> 1 & 1), k = first.z + (n >> 2);
      const double stored = static_cast<double>(data_[i + grid_.columns * (j + grid_.rows * k)]);
      whole_ = whole_ && !std::isnan(stored) && !volume_.isNoData(stored);
      corner_[n] = r.slope * stored + r.intercept;
    }
  }
  const Volume& volume_;
  const GridGeometry& grid_;
  const T* const data_;
  glm::dvec3 at_{std::numeric_limits<double>::quiet_NaN()};
  bool whole_ = false;
  double corner_[8] = {};
};

// The value less the level along a ray; NaN where there are no data.
template <class T>
class AlongRay {
 public:
  AlongRay(const ShellsJob& job, double level, const PatientRay& ray)
      : sampler_(*job.volume),
        cell_(*job.volume),
        level_(level),
        origin_((job.volume->voxelFromPatient() * ray.origin).p),
        direction_(job.volume->voxelFromPatient().linear * ray.direction.v) {}
  glm::dvec3 at(double t) const { return origin_ + t * direction_; }
  double operator()(double t) const {
    const glm::dvec3 p = at(t);
    return (cell_.holds(p) ? cell_.value(p) : sampler_.linear(p, ignored_)) - level_;
  }
  double stepLength_mm() const {
    const glm::dvec3 d = glm::abs(direction_);
    return kStep_vox / std::max(d.x, std::max(d.y, d.z));
  }

  // Where it is 0, next to t; nothing where the ray does not pass the level in reach.
  std::optional<double> zeroNear(double t) const {
    const double h = stepLength_mm(), middle = (*this)(t);
    double before = middle, behind = middle;
    for (int n = 1; n <= kSteps; ++n) {
      const double nearer = (*this)(t - n * h), farther = (*this)(t + n * h);
      const bool inFront = passes(nearer, before), atBack = passes(behind, farther);
      if (inFront || atBack) {
        const double a = inFront ? zeroWithin(t - n * h, nearer, t - (n - 1) * h, before) : t,
                     b = atBack ? zeroWithin(t + (n - 1) * h, behind, t + n * h, farther) : t;
        return !atBack || (inFront && t - a <= b - t) ? a : b;
      }
      before = nearer, behind = farther;
    }
    return std::nullopt;
  }

  // Per voxel. Along an axis the field is linear within a cell, so differences are exact but for rounding;
  // that of the sampler is the same at both places.
  glm::dvec3 gradient(double t) const {
    if (const glm::dvec3 p = at(t); cell_.holds(p)) return cell_.gradient(p);
    constexpr double kSmall_vox = 256 * kPositionUnit;
    glm::dvec3 g;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 low = at(t), high = low;
      low[axis] -= kSmall_vox, high[axis] += kSmall_vox;
      g[axis] = (sampler_.linear(high, ignored_) - sampler_.linear(low, ignored_)) / (2 * kSmall_vox);
    }
    return g;
  }

 private:
  static bool passes(double a, double b) { return (a < 0 && b >= 0) || (a >= 0 && b < 0); }
  // Secant steps within a bracket (Illinois): the field along an eighth of a voxel is nearly straight.
  double zeroWithin(double a, double fa, double b, double fb) const {
    double t = a;
    for (int n = 0; n < 8 && b - a > 1e-9; ++n) {
      t = a + (b - a) * fa / (fa - fb);
      const double f = (*this)(t);
      if (f == 0 || std::isnan(f)) break;
      if ((f < 0) == (fa < 0))
        a = t, fa = f, fb *= 0.5;
      else
        b = t, fb = f, fa *= 0.5;
    }
    return t;
  }

  const GeneralSampler<T> sampler_;
  mutable Cell<T> cell_;
  const double level_;
  const glm::dvec3 origin_, direction_;
  mutable std::uint64_t ignored_ = 0;
};

// Where the inside reaches the volume's border, shells close on its flat faces.
bool onBorder(const ShellsJob& job, PatientPoint p) {
  constexpr double kOnBorder_mm = 1e-3;
  return std::any_of(job.kept.begin(), job.kept.begin() + kBoxPlanes,
                     [&](const HalfSpace& h) { return h.distance_mm(p) > -kOnBorder_mm; });
}

template <class T>
double shareOf(const ShellsJob& job, double level, const PatientRay& ray, double t_mm, double flat) {
  const AlongRay<T> along(job, level, ray);
  if (onBorder(job, ray.at(t_mm)) && along(t_mm) >= 0) return flat;
  const std::optional<double> t = along.zeroNear(t_mm);
  if (!t) return flat;
  const glm::dvec3 normal = glm::transpose(job.volume->voxelFromPatient().linear) * along.gradient(*t);
  const double size = glm::length(normal);
  if (!(size > 0) || !std::isfinite(size)) return flat;
  return std::min(1.0, kAmbient + kDiffuse * std::abs(glm::dot(normal, ray.direction.v)) / size);
}

}  // namespace

double litShare(const ShellsJob& job, std::size_t shell, double x, double y, double t_mm, double flat) {
  const double level = job.shells[shell].level;
  const PatientRay ray = job.camera.ray(x, y);
  switch (job.volume->type()) {
    case VoxelType::U8:
      return shareOf<std::uint8_t>(job, level, ray, t_mm, flat);
    case VoxelType::I8:
      return shareOf<std::int8_t>(job, level, ray, t_mm, flat);
    case VoxelType::U16:
      return shareOf<std::uint16_t>(job, level, ray, t_mm, flat);
    case VoxelType::I16:
      return shareOf<std::int16_t>(job, level, ray, t_mm, flat);
    case VoxelType::U32:
      return shareOf<std::uint32_t>(job, level, ray, t_mm, flat);
    case VoxelType::I32:
      return shareOf<std::int32_t>(job, level, ray, t_mm, flat);
    case VoxelType::F32:
      break;
  }
  return shareOf<float>(job, level, ray, t_mm, flat);
}

}  // namespace vernier::native
