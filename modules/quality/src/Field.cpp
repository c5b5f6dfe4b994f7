// SPDX-License-Identifier: GPL-3.0-or-later
#include "Field.h"

#include <algorithm>
#include <cmath>

#include "Gauss.h"

namespace vernier::quality {
namespace {

std::size_t idx(std::int64_t n) { return static_cast<std::size_t>(n); }

// Where the line x0 + dx * t crosses the cell faces of an axis with n samples, for t in (t0, t1).
void addCrossings(double x0, double dx, std::int64_t n, bool nearest, double t0, double t1,
                  std::vector<double>& out) {
  if (dx == 0) return;
  const auto add = [&](double face) {
    const double t = (face - x0) / dx;
    if (t > t0 && t < t1) out.push_back(t);
  };
  const double last = static_cast<double>(n) - 1, shift = nearest ? 0.5 : 0.0;
  const double a = x0 + dx * t0, b = x0 + dx * t1;
  const double from = std::max(0.0, std::ceil(std::min(a, b) - shift));
  const double to = std::min(last, std::floor(std::max(a, b) - shift));
  for (double m = from; m <= to; ++m) add(m + shift);
  add(-0.5);
  add(last + 0.5);
}

}  // namespace

LocalRange Piece::extremes() const {
  LocalRange r;
  if (plain) {
    r.add(numerator(0));
    r.add(numerator(1));
    for (double u : rootsInside(derivative(numerator))) r.add(numerator(u));
    return r;
  }
  // At an end all the weight may be gone, and numerator and weight with it; a hair inside, the value is that
  // of the limit to 1e-7 of the corners' range, and the weight still stands clear of rounding.
  constexpr double hair = 1e-7;
  r.add((*this)(hair));
  r.add((*this)(1 - hair));
  for (double u : rootsInside(derivative(numerator) * weight - numerator * derivative(weight)))
    if (u > hair && u < 1 - hair) r.add((*this)(u));
  return r;
}

double Piece::mean() const {
  if (!plain) return integral(*this, 0, 1);
  double sum = 0;
  for (int n = 0; n <= numerator.degree; ++n) sum += numerator.c[static_cast<std::size_t>(n)] / (n + 1);
  return sum;
}

std::optional<Field::Span> Field::spanOf(double mid, double a, double b, std::int64_t n) const {
  const double last = static_cast<double>(n - 1);
  if (!(mid >= -0.5 - kBorderSlack_vox && mid <= last + 0.5 + kBorderSlack_vox)) return std::nullopt;
  if (nearest_) {
    const auto i = static_cast<std::int64_t>(std::clamp(std::floor(mid + 0.5), 0.0, last));
    return Span{i, i, 0, 0};
  }
  if (mid <= 0) return Span{0, 0, 0, 0};
  if (mid >= last) return Span{n - 1, n - 1, 0, 0};
  const double lo = std::floor(mid);
  const auto i = static_cast<std::int64_t>(lo);
  return Span{i, i + 1, std::clamp(a - lo, 0.0, 1.0), std::clamp(b - lo, 0.0, 1.0)};
}

std::optional<Field::Span> Field::sliceSpanOf(double mid, double a, double b) const {
  const GridGeometry& g = v_.grid();
  if (g.even()) return spanOf(mid, a, b, g.slices);
  const auto held = [](std::int64_t s) { return Span{s, s, 0, 0}; };
  const auto z = [&](std::int64_t s) { return g.sliceOrigin_vox[idx(s)].z; };
  const double reach = 0.5 + kBorderSlack_vox;
  if (mid <= z(0)) return mid >= z(0) - reach ? std::optional(held(0)) : std::nullopt;
  const std::int64_t last = g.slices - 1;
  if (mid >= z(last)) return mid <= z(last) + reach ? std::optional(held(last)) : std::nullopt;
  const auto above = std::upper_bound(g.sliceOrigin_vox.begin(), g.sliceOrigin_vox.end(), mid,
                                      [](double v, const glm::dvec3& o) { return v < o.z; });
  const std::int64_t s = above - g.sliceOrigin_vox.begin() - 1;
  const double below_vox = mid - z(s), above_vox = z(s + 1) - mid;
  if (isGap(s)) {
    if (below_vox <= reach && below_vox <= above_vox) return held(s);
    return above_vox <= reach ? std::optional(held(s + 1)) : std::nullopt;
  }
  if (nearest_) return held(below_vox < above_vox ? s : s + 1);
  const double width = z(s + 1) - z(s);
  return Span{s, s + 1, std::clamp((a - z(s)) / width, 0.0, 1.0), std::clamp((b - z(s)) / width, 0.0, 1.0)};
}

bool Field::isGap(std::int64_t slice) const {
  const auto& gaps = v_.grid().gapAfter;
  return std::binary_search(gaps.begin(), gaps.end(), slice);
}

std::optional<double> Field::voxel(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const double stored = v_.stored(i, j, k);
  if (v_.isNoData(stored)) return std::nullopt;
  const ModalityRescale& r = v_.rescaleOf(k);
  const double value = r.slope * stored + r.intercept;
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

glm::dvec2 Field::offsetOf(std::int64_t slice) const {
  const GridGeometry& g = v_.grid();
  return g.even() ? glm::dvec2(0) : glm::dvec2(g.sliceOrigin_vox[idx(slice)]);
}

Field::Corners Field::cornersOf(std::int64_t slice, glm::dvec3 mid, glm::dvec3 a, glm::dvec3 b,
                                LocalRange* range) const {
  const GridGeometry& g = v_.grid();
  const glm::dvec2 o = offsetOf(slice);
  Corners c;
  const auto x = spanOf(mid.x - o.x, a.x - o.x, b.x - o.x, g.columns);
  const auto y = spanOf(mid.y - o.y, a.y - o.y, b.y - o.y, g.rows);
  if (!x || !y) return c;
  c.x = *x;
  c.y = *y;
  for (std::size_t n = 0; n < 4; ++n) {
    const std::int64_t i = n & 1 ? x->hi : x->lo, j = n & 2 ? y->hi : y->lo;
    const std::optional<double> value = voxel(i, j, slice);
    if (!value) continue;
    c.value[n] = *value;
    c.valid[n] = true;
    if (range) range->add(*value);
  }
  return c;
}

std::optional<Piece> Field::piece(glm::dvec3 origin, glm::dvec3 step, double begin, double end,
                                  LocalRange* range) const {
  const glm::dvec3 a = origin + begin * step, b = origin + end * step;
  const glm::dvec3 mid = origin + 0.5 * (begin + end) * step;
  const auto k = sliceSpanOf(mid.z, a.z, b.z);
  if (!k) return std::nullopt;
  if (cubic_)
    if (std::optional<Poly> p = cubicAlong(*k, mid, a, b, range)) return Piece{begin, end, *p, {}, true};
  LocalRange local;
  std::array<Poly, 2> value, weight;
  bool plain = true;
  for (std::size_t n = 0; n < 2; ++n) {
    if (n == 1 && k->hi == k->lo) {
      value[1] = value[0];
      weight[1] = weight[0];
      break;
    }
    const Corners c = cornersOf(n == 0 ? k->lo : k->hi, mid, a, b, &local);
    const Poly fx = line(c.x.f0, c.x.f1), fy = line(c.y.f0, c.y.f1);
    const auto bilinear = [&](auto f) {
      const auto constant = [&](std::size_t m) { return Poly{{f(m)}, 0}; };
      return mix(mix(constant(0), constant(1), fx), mix(constant(2), constant(3), fx), fy);
    };
    value[n] = bilinear([&](std::size_t m) { return c.value[m]; });
    weight[n] = bilinear([&](std::size_t m) { return c.valid[m] ? 1.0 : 0.0; });
    for (bool valid : c.valid) plain = plain && valid;
  }
  const Poly fz = line(k->f0, k->f1);
  Piece p{begin, end, mix(value[0], value[1], fz), mix(weight[0], weight[1], fz), plain};
  if (!plain && p.weight(0.5) < kLeastWeight) return std::nullopt;
  if (range && local.min <= local.max) {
    range->add(local.min);
    range->add(local.max);
  }
  return p;
}

// The same as piece() for a point, without polynomials: this is what most of the work is.
std::optional<double> Field::at(glm::dvec3 p, LocalRange* range) const {
  const auto k = sliceSpanOf(p.z, p.z, p.z);
  if (!k) return std::nullopt;
  if (cubic_)
    if (const std::optional<double> value = cubicAt(*k, p, range)) return value;
  LocalRange local;
  std::array<double, 2> value{}, weight{};
  const std::size_t slices = k->hi == k->lo ? 1 : 2;
  for (std::size_t n = 0; n < slices; ++n) {
    const Corners c = cornersOf(n == 0 ? k->lo : k->hi, p, p, p, &local);
    const auto bilinear = [&](auto f) {
      const double upper = f(0) + c.x.f0 * (f(1) - f(0)), lower = f(2) + c.x.f0 * (f(3) - f(2));
      return upper + c.y.f0 * (lower - upper);
    };
    value[n] = bilinear([&](std::size_t m) { return c.value[m]; });
    weight[n] = bilinear([&](std::size_t m) { return c.valid[m] ? 1.0 : 0.0; });
  }
  if (slices == 1) {
    value[1] = value[0];
    weight[1] = weight[0];
  }
  const double w = weight[0] + k->f0 * (weight[1] - weight[0]);
  if (w < kLeastWeight) return std::nullopt;
  if (range) {
    range->add(local.min);
    range->add(local.max);
  }
  const double sum = value[0] + k->f0 * (value[1] - value[0]);
  return w == 1 ? sum : sum / w;
}

glm::dvec3 Field::gradient(glm::dvec3 p, glm::dvec3 cell) const {
  const auto k = sliceSpanOf(cell.z, p.z, p.z);
  if (!k) return glm::dvec3(0);
  // Of a slice: value and derivatives along columns and rows, of the numerator and of the weight.
  struct Plane {
    glm::dvec3 value{0}, weight{0};
  };
  const auto planeOf = [&](std::int64_t slice) {
    const Corners c = cornersOf(slice, cell, p, p, nullptr);
    const double x = c.x.f0, y = c.y.f0, dx = c.x.hi > c.x.lo ? 1 : 0, dy = c.y.hi > c.y.lo ? 1 : 0;
    const auto of = [&](auto f) {
      const double upper = f(0) + x * (f(1) - f(0)), lower = f(2) + x * (f(3) - f(2));
      return glm::dvec3(dx * ((1 - y) * (f(1) - f(0)) + y * (f(3) - f(2))), dy * (lower - upper),
                        upper + y * (lower - upper));
    };
    return Plane{of([&](std::size_t n) { return c.value[n]; }),
                 of([&](std::size_t n) { return c.valid[n] ? 1.0 : 0.0; })};
  };
  const Plane a = planeOf(k->lo), b = k->hi == k->lo ? a : planeOf(k->hi);
  const GridGeometry& g = v_.grid();
  const double height =
      g.even() || k->hi == k->lo ? 1 : g.sliceOrigin_vox[idx(k->hi)].z - g.sliceOrigin_vox[idx(k->lo)].z;
  // x and y: derivatives; z: the value itself.
  const glm::dvec3 value = a.value + k->f0 * (b.value - a.value),
                   weight = a.weight + k->f0 * (b.weight - a.weight);
  if (weight.z < kLeastWeight) return glm::dvec3(0);
  const glm::dvec3 dValue(value.x, value.y, (b.value.z - a.value.z) / height),
      dWeight(weight.x, weight.y, (b.weight.z - a.weight.z) / height);
  return (dValue * weight.z - value.z * dWeight) / (weight.z * weight.z);
}

std::vector<double> Field::cuts(glm::dvec3 origin, glm::dvec3 step) const {
  const GridGeometry& g = v_.grid();
  std::vector<double> t{0};
  if (g.even()) {
    addCrossings(origin.z, step.z, g.slices, nearest_, 0, 1, t);
  } else if (step.z != 0) {
    const double lo = std::min(origin.z, origin.z + step.z) - 2,
                 hi = std::max(origin.z, origin.z + step.z) + 2;
    const auto& o = g.sliceOrigin_vox;
    const auto first =
        std::lower_bound(o.begin(), o.end(), lo, [](const glm::dvec3& p, double v) { return p.z < v; });
    for (auto s = first == o.begin() ? first : first - 1; s != o.end(); ++s) {
      // The slice itself, the ends of its hold, and the middle to the next one, where nearest changes over.
      const double next = s + 1 != o.end() ? (s + 1)->z : s->z;
      for (double face : {s->z, s->z - 0.5, s->z + 0.5, 0.5 * (s->z + next)}) {
        const double at = (face - origin.z) / step.z;
        if (at > 0 && at < 1) t.push_back(at);
      }
      if (s->z > hi) break;
    }
  }
  t.push_back(1);
  std::sort(t.begin(), t.end());
  const std::size_t zPieces = t.size() - 1;
  std::vector<double> all = t;
  for (std::size_t n = 0; n < zPieces; ++n) {
    const double z = origin.z + 0.5 * (t[n] + t[n + 1]) * step.z;
    const auto k = sliceSpanOf(z, z, z);
    if (!k) continue;
    const std::int64_t reach = cubic_ ? 1 : 0;
    for (std::int64_t slice = std::max<std::int64_t>(k->lo - reach, 0);
         slice <= std::min(k->hi + reach, g.slices - 1); ++slice) {
      const glm::dvec2 o = offsetOf(slice);
      if (slice != k->lo && o == offsetOf(k->lo)) continue;
      addCrossings(origin.x - o.x, step.x, g.columns, nearest_, t[n], t[n + 1], all);
      addCrossings(origin.y - o.y, step.y, g.rows, nearest_, t[n], t[n + 1], all);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace vernier::quality
