// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/Sampling.h"

#include <algorithm>
#include <cmath>

#include "vernier/volume/Cubic.h"

namespace vernier {
namespace {

// Rounding of a point that was meant to lie on a border (a plane through the first slice, say) must not lose
// it.
constexpr double kBorderTolerance_vox = 1e-9;

// A position along one axis: the two indices between which it lies and the weight of the second.
struct Between {
  std::int64_t first = 0, second = 0;
  double t = 0;
};

// In [-0.5, n - 0.5], the border held; nullopt beyond.
std::optional<Between> alongAxis(double x, std::int64_t n) {
  const double last = static_cast<double>(n - 1);
  if (!(x >= -0.5 - kBorderTolerance_vox && x <= last + 0.5 + kBorderTolerance_vox)) return std::nullopt;
  x = std::clamp(x, 0.0, last);
  const double floor = std::floor(x);
  const std::int64_t i = static_cast<std::int64_t>(floor);
  return Between{i, std::min(i + 1, n - 1), x - floor};
}

std::optional<Between> betweenSlices(const GridGeometry& g, double z) {
  if (g.even()) return alongAxis(z, g.slices);
  const auto& o = g.sliceOrigin_vox;
  const double half = 0.5 + kBorderTolerance_vox;
  if (!(z >= o.front().z - half && z <= o.back().z + half)) return std::nullopt;
  const auto above =
      std::upper_bound(o.begin(), o.end(), z, [](double v, const glm::dvec3& s) { return v < s.z; });
  if (above == o.begin()) return Between{0, 0, 0};
  const std::int64_t s = (above - o.begin()) - 1;
  if (s == g.slices - 1) return Between{s, s, 0};
  const double below_vox = z - o[static_cast<std::size_t>(s)].z;
  const double above_vox = above->z - z;
  if (!std::binary_search(g.gapAfter.begin(), g.gapAfter.end(), s))
    return Between{s, s + 1, below_vox / (below_vox + above_vox)};
  if (std::min(below_vox, above_vox) > half) return std::nullopt;
  return below_vox < above_vox ? Between{s, s, 0} : Between{s + 1, s + 1, 0};
}

glm::dvec2 originOf(const GridGeometry& g, std::int64_t slice) {
  return g.even() ? glm::dvec2(0) : glm::dvec2(g.sliceOrigin_vox[static_cast<std::size_t>(slice)]);
}

struct WeightedSum {
  double weight = 0, value = 0;
  void add(const Volume& v, std::int64_t i, std::int64_t j, std::int64_t k, double w) {
    if (!(w > 0)) return;
    const VoxelValue x = v.probe(i, j, k);
    if (x.noData) return;
    weight += w;
    value += w * x.modality;
  }
};

void addSlice(WeightedSum& sum, const Volume& volume, glm::dvec2 at, std::int64_t k, double w) {
  if (!(w > 0)) return;
  const GridGeometry& g = volume.grid();
  at -= originOf(g, k);
  const auto x = alongAxis(at.x, g.columns);
  const auto y = alongAxis(at.y, g.rows);
  if (!x || !y) return;
  sum.add(volume, x->first, y->first, k, w * (1 - x->t) * (1 - y->t));
  sum.add(volume, x->second, y->first, k, w * x->t * (1 - y->t));
  sum.add(volume, x->first, y->second, k, w * (1 - x->t) * y->t);
  sum.add(volume, x->second, y->second, k, w * x->t * y->t);
}

// Cubic: the samples first .. first + 3; those without weight may lie outside.
struct Four {
  std::int64_t first = 0;
  std::array<double, 4> weight{};
};

Four fourAlong(const Between& at, std::int64_t n) {
  if (at.first == at.second) return {at.first - 1, {0, 1, 0, 0}};
  return {at.first - 1, cubicWeights(at.t, at.first > 0 ? 1 : 0, at.second + 1 < n ? 1 : 0)};
}

Four fourSlices(const GridGeometry& g, const Between& z) {
  if (g.even() || z.first == z.second) return fourAlong(z, g.slices);
  const auto height = [&](std::int64_t s) { return g.sliceOrigin_vox[static_cast<std::size_t>(s)].z; };
  const auto distance =
      [&](std::int64_t lower) {  // to the next slice, in the cell's height; 0: none that counts
        if (lower < 0 || lower + 1 >= g.slices ||
            std::binary_search(g.gapAfter.begin(), g.gapAfter.end(), lower))
          return 0.0;
        const double d = (height(lower + 1) - height(lower)) / (height(z.second) - height(z.first));
        return d < kNearestNeighbour || d > kFurthestNeighbour ? 0.0 : d;
      };
  return {z.first - 1, cubicWeights(z.t, distance(z.first - 1), distance(z.second))};
}

// nullopt where cubic is not defined.
std::optional<double> cubicModality(const Volume& volume, const glm::dvec3& p, const Between& z) {
  const GridGeometry& g = volume.grid();
  const Four slices = fourSlices(g, z);
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (slices.weight[k] == 0) continue;
    const std::int64_t slice = slices.first + static_cast<std::int64_t>(k);
    const glm::dvec2 at = glm::dvec2(p) - originOf(g, slice);
    const auto x = alongAxis(at.x, g.columns), y = alongAxis(at.y, g.rows);
    if (!x || !y) return std::nullopt;
    const Four columns = fourAlong(*x, g.columns), rows = fourAlong(*y, g.rows);
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t i = 0; i < 4; ++i) {
        const double w = slices.weight[k] * rows.weight[j] * columns.weight[i];
        if (w == 0) continue;
        const VoxelValue v = volume.probe(columns.first + static_cast<std::int64_t>(i),
                                          rows.first + static_cast<std::int64_t>(j), slice);
        if (v.noData) return std::nullopt;
        sum += w * v.modality;
      }
  }
  return sum;
}

}  // namespace

std::optional<double> sampleModality(const Volume& volume, PatientPoint point, Interpolation interpolation) {
  if (volume.isColour()) return std::nullopt;
  if (interpolation == Interpolation::Nearest) {
    const auto nearest = probeStored(volume, point);
    if (!nearest || nearest->noData) return std::nullopt;
    return nearest->modality;
  }
  const glm::dvec3 p = (volume.voxelFromPatient() * point).p;
  const auto z = betweenSlices(volume.grid(), p.z);
  if (!z) return std::nullopt;
  if (interpolation == Interpolation::Cubic)
    if (const std::optional<double> value = cubicModality(volume, p, *z)) return value;
  WeightedSum sum;
  addSlice(sum, volume, glm::dvec2(p), z->first, 1 - z->t);
  addSlice(sum, volume, glm::dvec2(p), z->second, z->t);
  if (!(sum.weight > 0)) return std::nullopt;
  return sum.value / sum.weight;
}

std::optional<std::array<double, 4>> sampleColour(const Volume& volume, PatientPoint point,
                                                  Interpolation interpolation) {
  if (!volume.isColour()) return std::nullopt;
  std::array<double, 4> out{0, 0, 0, 255};
  for (int c = 0; c < volume.info().channels; ++c) {
    const auto v = sampleModality(volume.channel(c), point, interpolation);
    if (!v) return std::nullopt;
    out[static_cast<std::size_t>(c)] = *v;
  }
  return out;
}

std::optional<StoredProbe> probeStored(const Volume& volume, PatientPoint point) {
  const GridGeometry& g = volume.grid();
  const glm::dvec3 p = (volume.voxelFromPatient() * point).p;
  const auto z = betweenSlices(g, p.z);
  if (!z) return std::nullopt;
  StoredProbe probe;
  probe.k = z->t >= 0.5 ? z->second : z->first;
  const glm::dvec2 at = glm::dvec2(p) - originOf(g, probe.k);
  const auto x = alongAxis(at.x, g.columns);
  const auto y = alongAxis(at.y, g.rows);
  if (!x || !y) return std::nullopt;
  probe.i = x->t >= 0.5 ? x->second : x->first;
  probe.j = y->t >= 0.5 ? y->second : y->first;
  if (volume.isColour()) {
    probe.rgba = volume.rgba(probe.i, probe.j, probe.k);
    return probe;
  }
  const VoxelValue value = volume.probe(probe.i, probe.j, probe.k);
  probe.stored = value.stored;
  probe.modality = value.modality;
  probe.noData = value.noData;
  return probe;
}

}  // namespace vernier
