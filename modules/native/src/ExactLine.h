// SPDX-License-Identifier: GPL-3.0-or-later
// A line through a regular grid of trilinear cells, and what the field does along it.
//
// Voxel frame. Cell c of an axis lies between voxels c and c + 1; cells -1 and last are the held half-voxel
// borders, where both ends are the same voxel. The line is a + t * d, t in [0, 1].
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "vernier/base/Frames.h"

namespace vernier::native {

// A line that moves less than this along an axis stays within one cell of it, and may lie that far outside a
// border: positions are rounded, and a slab along a face was meant to be on it.
inline constexpr double kParallel_vox = 1e-9;

template <class T>
struct CellGrid {
  const T* data = nullptr;
  std::int64_t last[3] = {0, 0, 0};    // greatest voxel index
  std::int64_t stride[3] = {0, 0, 0};  // in voxels
};

// The field along a piece, s in [0, 1]: c0 + c1 s + c2 s^2 + c3 s^3.
struct Cubic {
  double c0 = 0, c1 = 0, c2 = 0, c3 = 0;
  double at(double s) const { return c0 + s * (c1 + s * (c2 + s * c3)); }
  // Bounds by the control points of Bernstein's form.
  bool mayExceed(double bound) const { return c0 + c1 / 3 > bound || c0 + (2 * c1 + c2) / 3 > bound; }
};

// Corners of a cell: bit 0 the next along x, bit 1 along y, bit 2 along z.
inline double trilinear(const double* v, const double* f) {
  const double a = v[0] + f[0] * (v[1] - v[0]), b = v[2] + f[0] * (v[3] - v[2]);
  const double c = v[4] + f[0] * (v[5] - v[4]), d = v[6] + f[0] * (v[7] - v[6]);
  const double low = a + f[1] * (b - a), high = c + f[1] * (d - c);
  return low + f[2] * (high - low);
}

// Along the fractions f + s * g: each interpolation multiplies by one linear factor.
inline Cubic cubicAlong(const double* v, const double* f, const double* g) {
  const auto edge = [&](int n) {
    const double d = v[n + 1] - v[n];
    return std::pair{v[n] + f[0] * d, g[0] * d};
  };
  const auto face = [&](int n) {
    const auto [p0, p1] = edge(n);
    const auto [q0, q1] = edge(n + 2);
    const double d0 = q0 - p0, d1 = q1 - p1;
    return Cubic{p0 + f[1] * d0, p1 + f[1] * d1 + g[1] * d0, g[1] * d1, 0};
  };
  const Cubic p = face(0), q = face(4);
  const double d0 = q.c0 - p.c0, d1 = q.c1 - p.c1, d2 = q.c2 - p.c2;
  return {p.c0 + f[2] * d0, p.c1 + f[2] * d1 + g[2] * d0, p.c2 + f[2] * d2 + g[2] * d1, g[2] * d2};
}

// Where the cubic's derivative is zero, strictly inside (0, 1); returns how many. A double root is no
// extremum.
inline int extremaInside(const Cubic& p, double* s) {
  const double a = 3 * p.c3, b = 2 * p.c2, c = p.c1;
  const double discriminant = b * b - 4 * a * c;
  if (!(discriminant > 0)) return 0;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  int n = 0;
  for (const double root : {q / a, c / q})  // a = 0: the first is infinite
    if (root > 0 && root < 1) s[n++] = root;
  return n;
}

// Walks the cells of a line in order.
template <class T>
class CellWalk {
 public:
  CellWalk(const CellGrid<T>& grid, const glm::dvec3& a, const glm::dvec3& d) : grid_(grid) {
    double begin = 0, end = 1;
    for (int n = 0; n < 3; ++n) {
      a_[n] = a[n], d_[n] = d[n];
      const double low = -0.5, high = static_cast<double>(grid.last[n]) + 0.5;
      if (std::abs(d[n]) <= kParallel_vox) {
        if (!(a[n] >= low - kParallel_vox && a[n] <= high + kParallel_vox)) end = -1;
        continue;
      }
      inverse_[n] = 1 / d[n];
      const double t0 = (low - a[n]) * inverse_[n], t1 = (high - a[n]) * inverse_[n];
      begin = std::max(begin, std::min(t0, t1));
      end = std::min(end, std::max(t0, t1));
    }
    begin_ = begin, end_ = end;
  }

  bool meetsVolume() const { return end_ > begin_; }
  double begin() const { return begin_; }
  double end() const { return end_; }

  // Puts the walk into the cell that holds position t.
  void enter(double t) {
    entry_ = t;
    for (int n = 0; n < 3; ++n) {
      const double floor = std::floor(a_[n] + t * d_[n]);
      setCell(n, std::clamp(static_cast<std::int64_t>(floor), std::int64_t{-1}, grid_.last[n]));
      if (std::abs(d_[n]) <= kParallel_vox) {
        next_[n] = std::numeric_limits<double>::infinity();
        continue;
      }
      forward_[n] = d_[n] > 0 ? 1 : -1;
      next_[n] = faceAhead(n);
    }
    findExit();
  }

  double entry() const { return entry_; }
  double exit() const { return exit_; }
  bool atEnd() const { return exit_ >= end_; }
  void step() {
    entry_ = exit_;
    setCell(axis_, cell_[axis_] + forward_[axis_]);
    next_[axis_] = faceAhead(axis_);
    findExit();
  }

  void corners(T* v) const {
    const T* p = grid_.data + (offset_[0] + offset_[1] + offset_[2]);
    const std::int64_t x = toNext_[0], y = toNext_[1], z = toNext_[2];
    v[0] = p[0], v[1] = p[x], v[2] = p[y], v[3] = p[x + y];
    p += z;
    v[4] = p[0], v[5] = p[x], v[6] = p[y], v[7] = p[x + y];
  }
  // Position t within the cell.
  void fractions(double t, double* f) const {
    for (int n = 0; n < 3; ++n) f[n] = a_[n] + t * d_[n] - static_cast<double>(cell_[n]);
  }
  const double* direction() const { return d_; }

 private:
  void setCell(int n, std::int64_t c) {
    cell_[n] = c;
    offset_[n] = std::clamp(c, std::int64_t{0}, grid_.last[n]) * grid_.stride[n];
    toNext_[n] = c >= 0 && c < grid_.last[n] ? grid_.stride[n] : 0;
  }
  // From the face's own integer, never from the last step.
  double faceAhead(int n) const {
    return (static_cast<double>(cell_[n] + (forward_[n] > 0 ? 1 : 0)) - a_[n]) * inverse_[n];
  }
  // Never before the entry, by whatever the rounding.
  void findExit() {
    axis_ = next_[0] < next_[1] ? (next_[0] < next_[2] ? 0 : 2) : (next_[1] < next_[2] ? 1 : 2);
    exit_ = std::max(entry_, std::min(next_[axis_], end_));
  }

  const CellGrid<T>& grid_;
  double a_[3] = {}, d_[3] = {}, inverse_[3] = {}, next_[3] = {};
  double begin_ = 0, end_ = 0, entry_ = 0, exit_ = 0;
  std::int64_t cell_[3] = {}, offset_[3] = {}, toNext_[3] = {};
  int forward_[3] = {}, axis_ = 0;
};

}  // namespace vernier::native
