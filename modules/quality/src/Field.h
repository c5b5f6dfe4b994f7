// SPDX-License-Identifier: GPL-3.0-or-later
// The field that a volume's voxels span, in the Voxel frame, in double: at a point, and along a straight line
// as a list of smooth pieces. GridGeometry.h says where voxels lie and what holds at gaps and borders.
#pragma once
#include <array>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "Polynomial.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Volume.h"

namespace vernier::quality {

// A border is still inside when rounding alone carried a point past it.
inline constexpr double kBorderSlack_vox = 1e-9;
// Valid corners that together weigh less than this do not make a value: a slice laid through voxel centres
// must not show the neighbour's value where rounding alone gave it a weight.
inline constexpr double kLeastWeight = 1e-6;

struct LocalRange {
  double min = std::numeric_limits<double>::infinity(), max = -std::numeric_limits<double>::infinity();
  void add(double v) {
    if (v < min) min = v;
    if (v > max) max = v;
  }
};

// The field along one piece of a line, u in [0, 1]: numerator / weight. `plain`: all corners valid, weight
// is 1.
struct Piece {
  double begin = 0, end = 0;  // on the line
  Poly numerator, weight;
  bool plain = true;
  double operator()(double u) const { return plain ? numerator(u) : numerator(u) / weight(u); }
  LocalRange extremes() const;
  double mean() const;
};

class Field {
 public:
  Field(const Volume& volume, Interpolation interpolation)
      : v_(volume),
        nearest_(interpolation == Interpolation::Nearest),
        cubic_(interpolation == Interpolation::Cubic) {}

  // `range`, when given, takes in the modality values of the corners.
  std::optional<double> at(glm::dvec3 p_vox, LocalRange* range = nullptr) const;

  // The field along origin + t * step, t from `begin` to `end`, which lies in one cell. nullopt: no data.
  std::optional<Piece> piece(glm::dvec3 origin, glm::dvec3 step, double begin, double end,
                             LocalRange* range) const;
  // Modality value; nullopt: no data.
  std::optional<double> voxel(std::int64_t i, std::int64_t j, std::int64_t k) const;

  // Per voxel step, of the linear field in the cell around `cell_vox`, continued to p_vox; 0 without data.
  glm::dvec3 gradient(glm::dvec3 p_vox, glm::dvec3 cell_vox) const;

  // Calls fn(piece) for each piece of origin + t * step, t in [0, 1], that has data, in ascending order,
  // until it returns false.
  template <class Fn>
  void alongLine(glm::dvec3 origin_vox, glm::dvec3 step_vox, LocalRange* range, Fn&& fn) const {
    std::vector<double> t = cuts(origin_vox, step_vox);
    for (std::size_t n = 0; n + 1 < t.size(); ++n) {
      if (t[n + 1] - t[n] <= 1e-12) continue;
      if (std::optional<Piece> p = piece(origin_vox, step_vox, t[n], t[n + 1], range))
        if (!fn(*p)) return;
    }
  }

 private:
  // Where a coordinate falls along one axis of n samples: lo and hi samples, and the fraction towards hi at u
  // = 0, 1.
  struct Span {
    std::int64_t lo = 0, hi = 0;
    double f0 = 0, f1 = 0;
  };
  std::vector<double> cuts(glm::dvec3 origin, glm::dvec3 step) const;
  std::optional<Span> spanOf(double mid, double a, double b, std::int64_t n) const;
  std::optional<Span> sliceSpanOf(double mid, double a, double b) const;
  glm::dvec2 offsetOf(std::int64_t slice) const;
  struct Corners {
    std::array<double, 4> value{};  // bit 0: hi column, bit 1: hi row
    std::array<bool, 4> valid{};
    Span x, y;
  };
  Corners cornersOf(std::int64_t slice, glm::dvec3 mid, glm::dvec3 a, glm::dvec3 b, LocalRange*) const;

  bool isGap(std::int64_t slice) const;
  // The modality value of a voxel; nullopt: no data.

  // The cubic field at a point of slice span `k`, and along a piece from a to b; nullopt where one of its
  // voxels has no data, so that the linear field holds there.
  std::optional<double> cubicAt(const Span& k, glm::dvec3 p, LocalRange*) const;
  std::optional<Poly> cubicAlong(const Span& k, glm::dvec3 mid, glm::dvec3 a, glm::dvec3 b,
                                 LocalRange*) const;
  template <class X>
  std::optional<X> cubic(const Span& k, glm::dvec3 mid, glm::dvec3 a, glm::dvec3 b, LocalRange*) const;
  template <class X>
  std::optional<X> cubicAcross(std::int64_t slice, glm::dvec3 mid, glm::dvec3 a, glm::dvec3 b,
                               LocalRange&) const;
  std::pair<double, double> outerSlices(const Span& k) const;

  const Volume& v_;
  bool nearest_ = false, cubic_ = false;
};

}  // namespace vernier::quality
