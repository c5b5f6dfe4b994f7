// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/CompareVolumes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "vernier/base/Threads.h"
#include "vernier/volume/Sampling.h"

namespace vernier::measure {
namespace {

// Places that agree within this part of a voxel are the same.
constexpr double kSame_vox = 1e-6;

bool sameLattice(const GridGeometry& a, const GridGeometry& b, glm::dvec3 offset) {
  if (a.columns != b.columns || a.rows != b.rows || a.slices != b.slices || a.gapAfter != b.gapAfter ||
      a.sliceOrigin_vox.size() != b.sliceOrigin_vox.size())
    return false;
  for (std::size_t k = 0; k < a.sliceOrigin_vox.size(); ++k)
    if (glm::length(a.sliceOrigin_vox[k] - b.sliceOrigin_vox[k]) > kSame_vox) return false;
  const glm::dvec3 spacing = a.spacing_mm();
  const double smallest = std::min({spacing.x, spacing.y, spacing.z});
  for (int n = 0; n < 8; ++n)
    if (glm::length(a.corner(n).p + offset - b.corner(n).p) > kSame_vox * smallest) return false;
  return true;
}

PatientPoint centreOf(const GridGeometry& g, std::int64_t i, std::int64_t j, std::int64_t k) {
  glm::dvec3 v(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
  if (!g.even()) {  // slices stand where they were acquired
    const glm::dvec3 o = g.sliceOrigin_vox[static_cast<std::size_t>(k)];
    v = {o.x + v.x, o.y + v.y, o.z};
  }
  return g.patientFromVoxel * VoxelPoint(v.x, v.y, v.z);
}

// Sums of one slice; means come at the end.
struct Sums {
  std::uint64_t n = 0, unmatched = 0;
  double absolute = 0, squares = 0, signedSum = 0, max = 0;
  void add(double d) {
    ++n;
    absolute += std::abs(d), squares += d * d, signedSum += d;
    max = std::max(max, std::abs(d));
  }
  void add(const Sums& o) {
    n += o.n, unmatched += o.unmatched;
    absolute += o.absolute, squares += o.squares, signedSum += o.signedSum;
    max = std::max(max, o.max);
  }
  VoxelDifference difference() const {
    VoxelDifference d;
    d.compared = n, d.unmatched = unmatched, d.max = max;
    if (n > 0) {
      const auto count = static_cast<double>(n);
      d.mean = absolute / count, d.rmse = std::sqrt(squares / count), d.bias = signedSum / count;
    }
    return d;
  }
};

}  // namespace

Result<VolumeDifference> compareVolumes(const Volume& a, const Volume& b, PatientVec offset) {
  if (a.isColour() || b.isColour())
    return makeError(ErrorCode::OptionInvalid,
                     "Colour volumes have no values to subtract; compare pictures of them.");
  if (a.info().unit != b.info().unit)
    return makeError(ErrorCode::OptionInvalid, "The values have different units (" + a.info().unit + " and " +
                                                   b.info().unit + "); only like can be compared.");
  const GridGeometry& g = a.grid();
  VolumeDifference out;
  out.unit = a.info().unit;
  const bool direct = sameLattice(g, b.grid(), offset.v);
  out.resampled = !direct;
  std::vector<Sums> sums(static_cast<std::size_t>(g.slices));
  parallelFor(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      for (std::int64_t j = 0; j < g.rows; ++j)
        for (std::int64_t i = 0; i < g.columns; ++i) {
          const auto k = static_cast<std::int64_t>(s);
          const VoxelValue p = a.probe(i, j, k);
          std::optional<double> q;
          if (direct) {
            if (const VoxelValue v = b.probe(i, j, k); !v.noData) q = v.modality;
          } else {
            q = sampleModality(b, PatientPoint(centreOf(g, i, j, k).p + offset.v));
          }
          if (p.noData && !q) continue;
          if (p.noData || !q)
            ++sums[s].unmatched;
          else
            sums[s].add(*q - p.modality);
        }
  });
  Sums all;
  for (std::size_t s = 0; s < sums.size(); ++s) {
    if (sums[s].max > all.max) out.worstSlice = static_cast<std::int64_t>(s);
    all.add(sums[s]);
    out.slices.push_back(sums[s].difference());
  }
  out.all = all.difference();
  return out;
}

}  // namespace vernier::measure
