// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/Bricks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Exclusion.h"
#include "VoxelAccess.h"
#include "vernier/base/Threads.h"

namespace vernier {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

float roundedDown(double x) {
  const float f = static_cast<float>(x);
  return f > x ? std::nextafter(f, -kInf) : f;
}
float roundedUp(double x) {
  const float f = static_cast<float>(x);
  return f < x ? std::nextafter(f, kInf) : f;
}

// First and last voxel that brick b can touch along an axis of n voxels, for in-plane slice offsets in [low,
// high].
struct Reach {
  std::int64_t first, last;
};
Reach reachOf(std::int64_t b, int edge, std::int64_t n, double low, double high) {
  const std::int64_t first = b * edge - static_cast<std::int64_t>(std::ceil(high));
  const std::int64_t last = (b + 1) * edge - static_cast<std::int64_t>(std::floor(low));
  return {std::clamp<std::int64_t>(first, 0, n - 1), std::clamp<std::int64_t>(last, 0, n - 1)};
}

// Extrema over a set of rows, column by column: the inner loop runs along the row, so that SIMD can take it.
template <class T>
struct ColumnExtrema {
  std::vector<T> min, max;
  std::vector<std::uint8_t> noData;
  explicit ColumnExtrema(std::size_t n) : min(n), max(n), noData(n) {}
  void clear() {
    std::fill(min.begin(), min.end(), std::numeric_limits<T>::max());
    std::fill(max.begin(), max.end(), std::numeric_limits<T>::lowest());
    std::fill(noData.begin(), noData.end(), std::uint8_t{0});
  }
  template <class Excluded>
  void addRow(const T* v, Excluded excluded) {
    T *const lows = min.data(), *const highs = max.data();
    std::uint8_t* const holes = noData.data();
    for (std::size_t i = 0, n = min.size(); i < n; ++i) {
      const T x = v[i];
      const bool out = excluded(x) | notANumber(x);
      const T low = out ? std::numeric_limits<T>::max() : x;
      const T high = out ? std::numeric_limits<T>::lowest() : x;
      lows[i] = low < lows[i] ? low : lows[i];
      highs[i] = high > highs[i] ? high : highs[i];
      holes[i] = static_cast<std::uint8_t>(holes[i] | static_cast<std::uint8_t>(out));
    }
  }
};

struct Wander {
  glm::dvec2 low{0.0}, high{0.0};
};
Wander wanderOf(const GridGeometry& g) {
  Wander w;
  for (std::size_t s = 0; s < g.sliceOrigin_vox.size(); ++s) {
    const glm::dvec2 o(g.sliceOrigin_vox[s]);
    w.low = s ? glm::min(w.low, o) : o;
    w.high = s ? glm::max(w.high, o) : o;
  }
  return w;
}

struct RowOfBricks {
  Bricks& b;
  std::size_t first;  // index of brick (0, by, bz)

  template <class T>
  void add(const ColumnExtrema<T>& columns, const ModalityRescale& r, std::int64_t n, const Wander& wander) {
    for (std::int64_t bx = 0; bx < b.nx; ++bx) {
      const Reach x = reachOf(bx, b.edge, n, wander.low.x, wander.high.x);
      const auto from = x.first, to = x.last + 1;
      const T low = *std::min_element(columns.min.begin() + from, columns.min.begin() + to);
      const T high = *std::max_element(columns.max.begin() + from, columns.max.begin() + to);
      const std::size_t at = first + static_cast<std::size_t>(bx);
      b.hasNoData[at] |= *std::max_element(columns.noData.begin() + from, columns.noData.begin() + to);
      if (low > high) continue;
      const double p = r.slope * static_cast<double>(low) + r.intercept;
      const double q = r.slope * static_cast<double>(high) + r.intercept;
      b.min[at] = std::min(b.min[at], roundedDown(std::min(p, q)));
      b.max[at] = std::max(b.max[at], roundedUp(std::max(p, q)));
    }
  }
};

bool gapWithin(const GridGeometry& g, Reach slices) {
  const auto at = std::lower_bound(g.gapAfter.begin(), g.gapAfter.end(), slices.first);
  return at != g.gapAfter.end() && *at < slices.last;
}

}  // namespace

Bricks makeBricks(const Volume& volume, int edge) {
  VERNIER_ASSERT(edge >= 1);
  const GridGeometry& g = volume.grid();
  const auto blocks = [edge](std::int64_t n) { return (n + edge - 1) / edge; };
  Bricks b;
  b.edge = edge;
  b.nx = blocks(g.columns);
  b.ny = blocks(g.rows);
  b.nz = blocks(g.slices);
  const std::size_t count = static_cast<std::size_t>(b.nx * b.ny * b.nz);
  b.min.assign(count, kInf);
  b.max.assign(count, -kInf);
  b.hasNoData.assign(count, 0);
  const Wander wander = wanderOf(g);

  withVoxels(volume.type(), volume.data(), [&](const auto* v) {
    using T = std::remove_cvref_t<decltype(*v)>;
    withExclusion<T>(volume.info().noData, [&](auto excluded) {
      parallelFor(static_cast<std::size_t>(b.ny * b.nz), 1, [&](std::size_t begin, std::size_t end) {
        ColumnExtrema<T> columns(static_cast<std::size_t>(g.columns));
        for (std::size_t n = begin; n < end; ++n) {
          const std::int64_t by = static_cast<std::int64_t>(n) % b.ny,
                             bz = static_cast<std::int64_t>(n) / b.ny;
          const Reach y = reachOf(by, edge, g.rows, wander.low.y, wander.high.y);
          const Reach z = reachOf(bz, edge, g.slices, 0, 0);
          RowOfBricks row{b, b.index(0, by, bz)};
          for (std::int64_t k = z.first; k <= z.last; ++k) {
            columns.clear();
            for (std::int64_t j = y.first; j <= y.last; ++j)
              columns.addRow(v + g.columns * (j + g.rows * k), excluded);
            row.add(columns, volume.rescaleOf(k), g.columns, wander);
          }
          if (gapWithin(g, z))
            std::fill_n(b.hasNoData.begin() + static_cast<std::ptrdiff_t>(row.first), b.nx, 1);
        }
      });
    });
  });
  return b;
}

}  // namespace vernier
