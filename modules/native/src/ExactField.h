// SPDX-License-Identifier: GPL-3.0-or-later
// The greatest value and the integrals of the trilinear field along a line, cell by cell (ExactLine.h). Even
// grids with data in every voxel.
#pragma once
#include <algorithm>
#include <limits>

#include "ExactLine.h"
#include "vernier/volume/Volume.h"

namespace vernier::native {

struct ExactWork {
  std::uint64_t cells = 0, samples = 0;
};

template <class T>
CellGrid<T> cellGridOf(const Volume& volume) {
  const GridGeometry& g = volume.grid();
  return {reinterpret_cast<const T*>(volume.data()),
          {g.columns - 1, g.rows - 1, g.slices - 1},
          {1, g.columns, g.columns * g.rows}};
}

// Stored values where `sign` is -1 are turned over, so that a minimum is a maximum too.
template <class T>
void signedCorners(const T* v, double sign, double* out) {
  for (int n = 0; n < 8; ++n) out[n] = sign * static_cast<double>(v[n]);
}

// The greatest value of one line after the other. The place of the last line's maximum is tried first:
// neighbouring lines often share it, and a good start leaves out most cells.
template <class T>
class Greatest {
 public:
  explicit Greatest(double sign) : sign_(sign) {}

  double along(CellWalk<T>& walk, ExactWork& work) {
    best_ = -std::numeric_limits<double>::infinity();
    if (place_ > walk.begin() && place_ < walk.end()) {
      walk.enter(place_);
      take(valueAt(walk, place_), place_, work);
    }
    within(walk, walk.begin(), walk.end(), work);
    return sign_ * best_;
  }

  // For lines that are searched part by part: what is reached already, signed as the stored values are here.
  void begin(double best, double place) { best_ = best, place_ = place; }
  double best() const { return best_; }
  double place() const { return place_; }
  // Cells from the one that holds `from` to the one that holds `to`.
  void within(CellWalk<T>& walk, double from, double to, ExactWork& work) {
    walk.enter(from);
    take(valueAt(walk, from), from, work);
    for (;; walk.step()) {
      ++work.cells;
      piece(walk, work);
      if (walk.atEnd() || walk.exit() >= to) break;
    }
  }

 private:
  void take(double value, double t, ExactWork& work) {
    ++work.samples;
    if (value > best_) best_ = value, place_ = t;
  }

  double valueAt(const CellWalk<T>& walk, double t) const {
    T stored[8];
    double v[8], f[3];
    walk.corners(stored);
    signedCorners(stored, sign_, v);
    walk.fractions(t, f);
    return trilinear(v, f);
  }

  bool mayWin(const T* v) const {
    if (sign_ > 0)
      return static_cast<double>(std::max(std::max(std::max(v[0], v[1]), std::max(v[2], v[3])),
                                          std::max(std::max(v[4], v[5]), std::max(v[6], v[7])))) > best_;
    return -static_cast<double>(std::min(std::min(std::min(v[0], v[1]), std::min(v[2], v[3])),
                                         std::min(std::min(v[4], v[5]), std::min(v[6], v[7])))) > best_;
  }

  // The piece's begin is the end of the last one, which was taken or could not win.
  void piece(const CellWalk<T>& walk, ExactWork& work) {
    T stored[8];
    walk.corners(stored);
    if (!mayWin(stored)) return;
    const double length = walk.exit() - walk.entry();
    double v[8], f[3], g[3], s[2];
    signedCorners(stored, sign_, v);
    walk.fractions(walk.entry(), f);
    for (int n = 0; n < 3; ++n) g[n] = length * walk.direction()[n];
    const Cubic cubic = cubicAlong(v, f, g);
    take(cubic.at(1), walk.exit(), work);
    if (!cubic.mayExceed(best_)) return;
    const int roots = extremaInside(cubic, s);
    for (int n = 0; n < roots; ++n) take(cubic.at(s[n]), walk.entry() + s[n] * length, work);
  }

  double sign_ = 1, best_ = 0;
  double place_ = -1;
};

// Simpson's rule is exact for the cubic of each piece.
template <class T>
double meanAlong(CellWalk<T>& walk, ExactWork& work) {
  T stored[8];
  double v[8], f[3], sum = 0, length = 0;
  const auto value = [&](double t) {
    ++work.samples;
    walk.fractions(t, f);
    return trilinear(v, f);
  };
  walk.enter(walk.begin());
  for (double atEntry = 0;; walk.step()) {
    ++work.cells;
    walk.corners(stored);
    signedCorners(stored, 1, v);
    if (length == 0) atEntry = value(walk.entry());
    const double l = walk.exit() - walk.entry();
    const double atExit = value(walk.exit());
    sum += l * (atEntry + 4 * value(0.5 * (walk.entry() + walk.exit())) + atExit);
    length += l;
    atEntry = atExit;
    if (walk.atEnd()) break;
  }
  return sum / (6 * length);
}

// Volume::make() notes what was not finite, except in volumes converted from others, where NaN is padding.
inline bool mayHoldNan(const Volume& v) {
  if (const OriginalVoxels* o = v.original()) return o->noData || o->type == VoxelType::F32;
  const auto& findings = v.info().findings;
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return f.code == "non-finite-voxels"; });
}

}  // namespace vernier::native
