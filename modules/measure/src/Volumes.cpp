// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes: of what reaches a level, counted in voxels, and of convex regions between planes.
#include <algorithm>

#include "Work.h"
#include "vernier/measure/ConvexBody.h"

namespace vernier::measure {
namespace {

// How thick each slice counts, in steps: half way to its neighbours, half a step at a gap and at the ends.
std::vector<double> thickness(const GridGeometry& g) {
  std::vector<double> t(static_cast<std::size_t>(g.slices), 1);
  if (g.even()) return t;
  for (std::size_t k = 0; k < t.size(); ++k) {
    const auto half = [&](std::size_t lower) {
      const bool gap =
          std::binary_search(g.gapAfter.begin(), g.gapAfter.end(), static_cast<std::int64_t>(lower));
      return gap ? 0.5 : (g.sliceOrigin_vox[lower + 1].z - g.sliceOrigin_vox[lower].z) / 2;
    };
    t[k] = (k > 0 ? half(k - 1) : 0.5) + (k + 1 < t.size() ? half(k) : 0.5);
  }
  return t;
}

class Region {
 public:
  Region(const Work& w, double level) : v_(*w.volume), g_(v_.grid()), stop_(w.stop) {
    in_.assign(static_cast<std::size_t>(g_.columns * g_.rows * g_.slices), 0);
    for (std::int64_t k = 0; k < g_.slices; ++k) {
      if (stop_.stop_requested()) throw Refused{makeError(ErrorCode::Cancelled, "")};
      for (std::int64_t j = 0; j < g_.rows; ++j)
        for (std::int64_t i = 0; i < g_.columns; ++i) {
          const VoxelValue x = v_.probe(i, j, k);
          in_[index(i, j, k)] = !x.noData && x.modality >= level;
        }
    }
  }
  // Keeps what hangs together with the seed.
  void connected(PatientPoint seed) {
    const auto at = voxelOf(seed);
    if (!at || !in_[*at]) refuse("The value at the seed is below the level; choose another place.");
    std::vector<std::size_t> open{*at};
    in_[*at] = 2;
    while (!open.empty()) {
      const std::size_t here = open.back();
      open.pop_back();
      forNeighbours(here, [&](std::optional<std::size_t> next, bool) {
        if (next && in_[*next] == 1) in_[*next] = 2, open.push_back(*next);
      });
    }
    for (std::uint8_t& x : in_) x = x == 2;
  }
  struct Count {
    std::uint64_t voxels = 0, faces = 0;
    double thickness = 0;  // sum over voxels, in steps
  };
  Count count() const {
    Count c;
    const std::vector<double> t = thickness(g_);
    const auto perSlice = static_cast<std::size_t>(g_.columns * g_.rows);
    for (std::size_t n = 0; n < in_.size(); ++n) {
      if (!in_[n]) continue;
      ++c.voxels;
      c.thickness += t[n / perSlice];
      forNeighbours(n, [&](std::optional<std::size_t> next, bool) { c.faces += !next || !in_[*next]; });
    }
    return c;
  }

 private:
  std::size_t index(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>(i + g_.columns * (j + g_.rows * k));
  }
  std::optional<std::size_t> voxelOf(PatientPoint p) const {
    glm::dvec3 x = (v_.voxelFromPatient() * p).p;
    std::int64_t k = std::llround(std::clamp(x.z, -1e9, 1e9));
    if (!g_.even()) {
      const auto nearest = std::min_element(g_.sliceOrigin_vox.begin(), g_.sliceOrigin_vox.end(),
                                            [&](const glm::dvec3& a, const glm::dvec3& b) {
                                              return std::abs(a.z - x.z) < std::abs(b.z - x.z);
                                            });
      if (std::abs(nearest->z - x.z) > 1) return std::nullopt;
      k = nearest - g_.sliceOrigin_vox.begin();
      x -= *nearest;
    }
    const std::int64_t i = std::llround(std::clamp(x.x, -1e9, 1e9)),
                       j = std::llround(std::clamp(x.y, -1e9, 1e9));
    if (i < 0 || j < 0 || k < 0 || i >= g_.columns || j >= g_.rows || k >= g_.slices) return std::nullopt;
    return index(i, j, k);
  }
  // fn(neighbour or nullopt at the border and at a gap, across slices)
  template <class Fn>
  void forNeighbours(std::size_t n, Fn&& fn) const {
    const auto columns = static_cast<std::size_t>(g_.columns),
               perSlice = columns * static_cast<std::size_t>(g_.rows);
    const std::size_t i = n % columns, j = n % perSlice / columns, k = n / perSlice;
    const auto give = [&](bool there, std::size_t next, bool across) {
      fn(there ? std::optional(next) : std::nullopt, across);
    };
    give(i > 0, n - 1, false);
    give(i + 1 < columns, n + 1, false);
    give(j > 0, n - columns, false);
    give(n % perSlice + columns < perSlice, n + columns, false);
    const auto gap = [&](std::size_t after) {
      return std::binary_search(g_.gapAfter.begin(), g_.gapAfter.end(), static_cast<std::int64_t>(after));
    };
    give(k > 0 && !gap(k - 1), n - perSlice, true);
    give(k + 1 < static_cast<std::size_t>(g_.slices) && !gap(k), n + perSlice, true);
  }
  const Volume& v_;
  const GridGeometry& g_;
  std::stop_token stop_;
  std::vector<std::uint8_t> in_;
};

// u^2: each face of the region's border lies within spacing^2 / 12 of where it is drawn, the others
// untouched: (face x spacing)^2 / 12, which is the voxel's volume, for every face.
void iso(Work& w, const IsoVolume& s) {
  const Volume& v = *w.volume;
  if (v.isColour()) refuse("Colours have no values to be measured.");
  if (!std::isfinite(s.level_val)) refuse("The level is not finite; give a number.");
  Region region(w, s.level_val);
  if (s.seed) region.connected(PatientPoint(*s.seed));
  const Region::Count c = region.count();
  if (c.voxels == 0) refuse("No voxel reaches the level.");
  const double voxel = std::abs(glm::determinant(v.grid().patientFromVoxel.linear));
  w.add("volume", c.thickness * voxel, w.unit + "3",
        w.expanded(static_cast<double>(c.faces) * voxel * voxel / 12));
  w.add("n", static_cast<double>(c.voxels), "1", std::nullopt);
  w.note("the choice of the level is not included in the +/-");
  if (!v.grid().gapAfter.empty()) w.note("missing slices are left out");
}

void convex(Work& w, const ConvexVolume& s) {
  const Result<ConvexBody> body = convexBody(s.planes);
  if (!body) throw Refused{body.error()};
  double variance = 0;  // each plane moves along its normal; the change of volume is its face's area
  for (std::size_t n = 0; n < body->faces.size(); ++n)
    variance += body->faces[n] * body->faces[n] * w.quadratic(body->normals[n]);
  w.add("volume", body->volume_mm3, w.unit + "3", w.expanded(variance));
  std::vector<Spot> corners(body->corners.begin(), body->corners.end());
  noteGaps(w, corners);
}

}  // namespace

void measureVolume(Work& w) {
  if (const auto* s = std::get_if<IsoVolume>(&w.what.shape)) iso(w, *s);
  if (const auto* s = std::get_if<ConvexVolume>(&w.what.shape)) convex(w, *s);
}

}  // namespace vernier::measure
