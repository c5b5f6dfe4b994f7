// SPDX-License-Identifier: GPL-3.0-or-later
// Pre-integration, diagonal by diagonal. Where back - front = m entries, the value passes each of the m
// intervals between entries in step / m, so all entries of one diagonal are made of the same pieces, joined
// front to back in windows of m: prefixes and suffixes of blocks of m (van Herk's running window), which
// needs no division and so loses nothing where little light is left.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "vernier/base/Threads.h"
#include "vernier/volume/TransferTable.h"

namespace vernier {
namespace {

// Gauss-Legendre on [0, 1].
constexpr std::array<double, 4> kNode{0.069431844202973714, 0.33000947820757187, 0.66999052179242813,
                                      0.93056815579702629};
constexpr std::array<double, 4> kWeight{0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                        0.17392742256872693};

// The limit from below; *At() of TransferFunction.h are the limits from above.
template <class Point, class Of>
auto before(const std::vector<Point>& points, double value, Of&& of) {
  const auto upper = std::lower_bound(points.begin(), points.end(), value,
                                      [](const Point& p, double v) { return p.value < v; });
  if (upper == points.begin()) return of(points.front());
  if (upper == points.end()) return of(points.back());
  const Point& a = *std::prev(upper);
  const double t = (value - a.value) / (upper->value - a.value);
  return of(a) + t * (of(*upper) - of(a));
}

// Integral of -ln(1 - a) over [0, s] where a goes from a0 by `slope`.
double depthAlong(double a0, double slope, double s) {
  const double u0 = 1 - a0, u1 = 1 - (a0 + slope * s);
  if (u0 <= 0 && u1 <= 0) return s > 0 ? std::numeric_limits<double>::infinity() : 0;
  // Opacities that hardly change: the closed form would be a difference of like numbers.
  if (std::abs(slope * s) < 1e-3 * std::max(u0, 0.0)) {
    double sum = 0;
    for (std::size_t q = 0; q < 4; ++q) sum -= kWeight[q] * std::log1p(-(a0 + slope * s * kNode[q]));
    return s * sum;
  }
  const auto primitive = [](double u) { return u > 0 ? u * std::log(u) - u : 0.0; };
  return (primitive(std::max(u1, 0.0)) - primitive(u0)) / slope;
}

// A stretch of values without a knot inside.
struct Piece {
  double share = 0;  // of the interval between two entries
  double depth = 0;  // mean of -ln(1 - a), +inf where all of it is opaque
  double a0 = 0, a1 = 0;
  glm::dvec3 c0{0}, c1{0};
  std::array<double, 4> within{};  // of the depth, up to the nodes
};

Piece pieceOf(const TransferFunction& f, double from, double to, double interval) {
  Piece p;
  p.share = (to - from) / interval;
  p.a0 = opacityAt(f, from), p.c0 = colourAt(f, from);
  p.a1 = before(f.opacities, to, [](const OpacityPoint& o) { return o.opacity; });
  p.c1 = before(f.colours, to, [](const ColourPoint& c) { return c.colour; });
  p.depth = depthAlong(p.a0, p.a1 - p.a0, 1);
  if (p.depth > 0 && std::isfinite(p.depth))
    for (std::size_t q = 0; q < 4; ++q) p.within[q] = depthAlong(p.a0, p.a1 - p.a0, kNode[q]) / p.depth;
  return p;
}

// Premultiplied colour, and what is left of the light behind.
struct Light {
  glm::dvec3 colour{0};
  double through = 1;
};
Light over(const Light& front, const Light& back) {
  return {front.colour + front.through * back.colour, front.through * back.through};
}

// Mean of exp(-depth up to s) over the piece, seen from its begin or its end.
double meanThrough(const Piece& p, double scale, bool turned) {
  const double whole = scale * p.depth;
  double sum = 0;
  if (whole <= 1) {
    for (std::size_t q = 0; q < 4; ++q)
      sum += kWeight[q] * std::exp(-whole * (turned ? 1 - p.within[3 - q] : p.within[q]));
    return sum;
  }
  // Steeper: in panels, as far as any light comes.
  const double a0 = turned ? p.a1 : p.a0, slope = turned ? p.a0 - p.a1 : p.a1 - p.a0;
  const int panels = static_cast<int>(std::min(64.0, std::ceil(2 * whole)));
  for (int n = 0; n < panels; ++n) {
    const double begin = scale * depthAlong(a0, slope, static_cast<double>(n) / panels);
    if (begin > 40) break;
    for (std::size_t q = 0; q < 4; ++q)
      sum += kWeight[q] / panels * std::exp(-scale * depthAlong(a0, slope, (n + kNode[q]) / panels));
  }
  return sum;
}

// The colour by parts: c dA = c(begin) - c(end) T + integral of T dc, bounded where the extinction is not.
Light lightOf(const Piece& p, double scale, bool turned) {
  const glm::dvec3& begin = turned ? p.c1 : p.c0;
  const glm::dvec3& end = turned ? p.c0 : p.c1;
  if (!(p.depth > 0)) return {};
  if (std::isinf(p.depth)) return {begin, 0};
  const double through = std::exp(-scale * p.depth);
  if (begin == end) return {begin * -std::expm1(-scale * p.depth), through};
  return {begin - end * through + (end - begin) * meanThrough(p, scale, turned), through};
}

class Maker {
 public:
  Maker(const TransferFunction& f, PreIntegratedTable& t)
      : f_(f), t_(t), lengths_(t.step_mm / f.opacityLength_mm) {
    const std::vector<double> knots = knotsOf(f);
    const double interval = (t.greatest - t.least) / (t.size - 1);
    auto knot = std::upper_bound(knots.begin(), knots.end(), t.least);
    for (int n = 0; n + 1 < t.size; ++n) {
      first_.push_back(pieces_.size());
      double from = t.valueOf(n);
      const double to = t.valueOf(n + 1);
      for (; knot != knots.end() && *knot < to; ++knot)
        if (*knot > from) pieces_.push_back(pieceOf(f, from, *knot, interval)), from = *knot;
      pieces_.push_back(pieceOf(f, from, to, interval));
    }
    first_.push_back(pieces_.size());
  }

  // The value stands still.
  void middle() const {
    for (int n = 0; n < t_.size; ++n) {
      const double opacity = opacityOver(opacityAt(f_, t_.valueOf(n)), lengths_);
      put(n, n, {opacity * colourAt(f_, t_.valueOf(n)), 1 - opacity});
    }
  }

  // Entries (i, i + m) and (i + m, i) for all i; m >= 1.
  void diagonal(int m) const {
    const int intervals = t_.size - 1;
    std::vector<Light> forth(static_cast<std::size_t>(intervals)), back(forth.size());
    for (int n = 0; n < intervals; ++n) intervalLight(n, lengths_ / m, forth[at(n)], back[at(n)]);
    windows(forth, m, false), windows(back, m, true);
  }

 private:
  static std::size_t at(int n) { return static_cast<std::size_t>(n); }

  void intervalLight(int n, double lengths, Light& forth, Light& back) const {
    for (std::size_t p = first_[at(n)]; p < first_[at(n) + 1]; ++p) {
      const double scale = lengths * pieces_[p].share;
      forth = over(forth, lightOf(pieces_[p], scale, false));
      back = over(lightOf(pieces_[p], scale, true), back);
    }
  }

  // Joins m neighbours from every place on; `turned`: seen from the last of them.
  void windows(const std::vector<Light>& one, int m, bool turned) const {
    const int n = static_cast<int>(one.size());
    const auto join = [turned](const Light& low, const Light& high) {
      return turned ? over(high, low) : over(low, high);
    };
    std::vector<Light> prefix(one), suffix(one);
    for (int i = 1; i < n; ++i)
      if (i % m != 0) prefix[at(i)] = join(prefix[at(i - 1)], one[at(i)]);
    for (int i = n - 2; i >= 0; --i)
      if ((i + 1) % m != 0) suffix[at(i)] = join(one[at(i)], suffix[at(i + 1)]);
    for (int i = 0; i + m <= n; ++i) {
      const Light light = i % m == 0 ? prefix[at(i + m - 1)] : join(suffix[at(i)], prefix[at(i + m - 1)]);
      turned ? put(i + m, i, light) : put(i, i + m, light);
    }
  }

  void put(int front, int back, const Light& light) const {
    float* const out = t_.rgba.data() + 4 * (at(front) + at(t_.size) * at(back));
    for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(std::clamp(light.colour[c], 0.0, 1.0));
    out[3] = static_cast<float>(1 - light.through);
  }

  const TransferFunction& f_;
  PreIntegratedTable& t_;
  double lengths_;
  std::vector<Piece> pieces_;
  std::vector<std::size_t> first_;  // piece of each interval, and the end
};

Error internal(const std::string& sentence) {
  return makeError(ErrorCode::Internal, sentence, "pre-integrated table");
}

}  // namespace

Result<PreIntegratedTable> makePreIntegratedTable(const TransferFunction& f, const Volume::Range& range,
                                                  double step_mm, int entries) {
  if (Result<void> ok = checkTransferFunction(f); !ok) return ok.error();
  if (!(range.min < range.max)) return internal("The range of values is empty.");
  if (!(step_mm > 0) || !std::isfinite(step_mm)) return internal("The step is no length.");
  if (entries < 2 || entries > kMostPreIntegratedEntries)
    return internal("The number of entries is out of range.");
  PreIntegratedTable t{range.min, range.max, step_mm, entries, {}};
  t.rgba.resize(4 * static_cast<std::size_t>(entries) * static_cast<std::size_t>(entries));
  const Maker maker(f, t);
  maker.middle();
  parallelFor(static_cast<std::size_t>(entries - 1), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) maker.diagonal(static_cast<int>(m) + 1);
  });
  return t;
}

}  // namespace vernier
