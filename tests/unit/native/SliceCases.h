// SPDX-License-Identifier: GPL-3.0-or-later
// Slice jobs for tests, and what they must give: brute force in double from sampleModality (volume's probe,
// tested by itself) and an interpolation of its own.
#pragma once
#include <limits>
#include <optional>

#include "../volume/Grids.h"
#include "vernier/native/Slice.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Voi.h"

namespace vernier::test {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

inline Images imagesFor(const native::SliceJob& job) {
  Images images;
  images.allocate(job.width_px, job.height_px, true);
  return images;
}

// A plane through the volume, turned at random, large enough that the volume's border is in the picture.
inline native::SliceJob randomJob(const Volume& volume, std::uint64_t seed, int width, int height) {
  const auto unit = [&](std::uint64_t n) { return 2 * randomUnit(seed, n) - 1; };
  const glm::dvec3 normal = glm::normalize(glm::dvec3(unit(0), unit(1), unit(2)));
  const glm::dvec3 right = glm::normalize(glm::cross(normal, glm::dvec3(unit(3), unit(4), unit(5))));
  const GridGeometry& g = volume.grid();
  const double diagonal_mm = glm::length(g.corner(7).p - g.corner(0).p) + g.spacing_mm().x;
  native::SliceJob job;
  job.volume = &volume;
  job.width_px = width;
  job.height_px = height;
  job.picture.mmPerPixel = 1.1 * diagonal_mm / width;
  job.picture.normal = PatientVec(normal);
  job.picture.right = PatientVec(right * job.picture.mmPerPixel);
  job.picture.down = PatientVec(glm::cross(normal, right) * -job.picture.mmPerPixel);
  const glm::dvec3 centre = g.centre().p + 0.1 * diagonal_mm * unit(6) * normal;
  job.picture.origin =
      PatientPoint(centre - 0.5 * width * job.picture.right.v - 0.5 * height * job.picture.down.v);
  job.window = {0, 100, VoiFunction::LinearExact, ""};
  job.background = {0.25, 0.5, 0.75};
  return job;
}

inline PatientPoint pointOf(const native::SliceJob& job, int x, int y, int k) {
  const double offset_mm = (k + 0.5) * job.slab.thickness_mm / job.slabSamples - 0.5 * job.slab.thickness_mm;
  return job.picture.origin + (x + 0.5) * job.picture.right + (y + 0.5) * job.picture.down +
         (job.slabSamples > 1 ? offset_mm : 0.0) * job.picture.normal;
}

// Value of one sample with least and greatest modality value of the voxels around it.
struct Truth {
  double value = kNan, least = kNan, greatest = kNan;
  bool inVolume = false;
  void widen(const Truth& o) {
    least = std::isnan(least) ? o.least : std::fmin(least, o.least);
    greatest = std::isnan(greatest) ? o.greatest : std::fmax(greatest, o.greatest);
  }
};

// Cubic on an even grid, one axis after the other: Keys' kernel over samples that are continued beyond the
// border by his condition f(-1) = 3 f(0) - 3 f(1) + f(2). NaN where a voxel that counts has no data.
inline double keysAlong(const Volume& v, const glm::dvec3& p, int axis, glm::dvec3 at, Truth& used) {
  const GridGeometry& g = v.grid();
  if (axis < 0) {
    const auto i = static_cast<std::int64_t>(at.x), j = static_cast<std::int64_t>(at.y),
               k = static_cast<std::int64_t>(at.z);
    if (v.isNoData(v.stored(i, j, k))) return kNan;
    const double m = v.modality(i, j, k);
    used.widen({m, m, m, true});
    return m;
  }
  const double n = static_cast<double>(axis == 0 ? g.columns : axis == 1 ? g.rows : g.slices);
  const auto sample = [&](double index) {
    at[axis] = index;
    return keysAlong(v, p, axis - 1, at, used);
  };
  const auto beyond = [&](double a, double b, double c) {  // the samples nearest to the border first
    if (n < 2) return sample(a);
    return n < 3 ? 2 * sample(a) - sample(b) : 3 * sample(a) - 3 * sample(b) + sample(c);
  };
  const double cell = std::floor(p[axis]), t = p[axis] - cell;
  if (t == 0) return sample(cell);
  double sum = 0;
  for (int tap = -1; tap <= 2; ++tap) {
    const double x = std::abs(t - tap), index = cell + tap;
    const double w = x < 1 ? (1.5 * x - 2.5) * x * x + 1 : ((-0.5 * x + 2.5) * x - 4) * x + 2;
    sum += w * (index < 0 ? beyond(0, 1, 2) : index >= n ? beyond(n - 1, n - 2, n - 3) : sample(index));
  }
  return sum;
}

// Even grids: the eight corners written out. Other grids: sampleModality, and the voxels of the nearest two
// slices.
inline Truth sampleTruth(const Volume& v, PatientPoint point, Interpolation interpolation) {
  Truth t;
  const GridGeometry& g = v.grid();
  const glm::dvec3 p = (v.voxelFromPatient() * point).p;
  const glm::dvec3 n(g.columns, g.rows, g.slices);
  if (!g.even()) {
    const auto value = sampleModality(v, point, interpolation);
    const auto probe = probeStored(v, point);
    t.inVolume = probe.has_value() || value.has_value();
    if (!value) return t;
    t.value = *value;
    const std::int64_t reach = interpolation == Interpolation::Cubic ? 2 : 1;
    for (std::int64_t k = std::max<std::int64_t>(0, probe ? probe->k - reach : 0);
         k <= std::min(g.slices - 1, probe ? probe->k + reach : g.slices - 1); ++k)
      for (std::int64_t j = std::max<std::int64_t>(0, probe ? probe->j - reach : 0);
           j <= std::min(g.rows - 1, probe ? probe->j + reach : g.rows - 1); ++j)
        for (std::int64_t i = std::max<std::int64_t>(0, probe ? probe->i - reach : 0);
             i <= std::min(g.columns - 1, probe ? probe->i + reach : g.columns - 1); ++i) {
          if (v.isNoData(v.stored(i, j, k))) continue;
          const double m = v.modality(i, j, k);
          t.widen({m, m, m, true});
        }
    return t;
  }
  for (int a = 0; a < 3; ++a)
    if (!(p[a] >= -0.5 && p[a] <= n[a] - 0.5)) return t;
  t.inVolume = true;
  if (interpolation == Interpolation::Cubic) {
    Truth used;
    used.value = keysAlong(v, glm::clamp(p, glm::dvec3(0), n - 1.0), 2, {}, used);
    used.inVolume = true;
    if (!std::isnan(used.value)) return used;
  }
  const glm::dvec3 q =
      glm::clamp(interpolation == Interpolation::Nearest ? glm::floor(p + 0.5) : p, glm::dvec3(0), n - 1.0);
  const glm::dvec3 low = glm::min(glm::floor(q), glm::max(n - 2.0, glm::dvec3(0)));
  double sum = 0, weight = 0;
  for (int c = 0; c < 8; ++c) {
    const glm::dvec3 corner = low + glm::dvec3(c & 1, c >> 1 & 1, c >> 2);
    const glm::dvec3 w = 1.0 - glm::abs(q - corner);
    const double product = w.x * w.y * w.z;
    if (product <= 0 || corner.x >= n.x || corner.y >= n.y || corner.z >= n.z) continue;
    const auto i = static_cast<std::int64_t>(corner.x), j = static_cast<std::int64_t>(corner.y),
               k = static_cast<std::int64_t>(corner.z);
    if (v.isNoData(v.stored(i, j, k))) continue;
    const double m = v.modality(i, j, k);
    sum += product * m;
    weight += product;
    t.widen({m, m, m, true});
  }
  if (weight > 1e-6) t.value = sum / weight;
  return t;
}

// All samples of a pixel put together. Returns how many lay in the volume through `samples`.
inline Truth pixelTruth(const native::SliceJob& job, int x, int y, std::uint64_t& samples) {
  Truth all;
  double sum = 0;
  int n = 0;
  for (int k = 0; k < job.slabSamples; ++k) {
    const Truth t = sampleTruth(*job.volume, pointOf(job, x, y, k), job.interpolation);
    samples += t.inVolume ? 1 : 0;
    if (std::isnan(t.value)) continue;
    all.widen(t);
    sum += t.value;
    ++n;
    if (job.slab.mode == SlabMode::Max)
      all.value = std::isnan(all.value) ? t.value : std::fmax(all.value, t.value);
    if (job.slab.mode == SlabMode::Min)
      all.value = std::isnan(all.value) ? t.value : std::fmin(all.value, t.value);
  }
  if (n > 0 && (job.slab.mode == SlabMode::Mean || job.slabSamples == 1)) all.value = sum / n;
  return all;
}

// RENDERING 3, Slices: |engine - double| <= 1e-4 of the local range + 1e-6 of the stored range (here as
// modality).
inline void expectWithinBound(const native::SliceJob& job, const std::string& what) {
  Images images = imagesFor(job);
  ASSERT_TRUE(native::drawSlice(job, images).ok()) << what;
  const auto range = job.volume->modalityRange();
  const double whole = range ? range->max - range->min : 0;
  std::uint64_t samples = 0;
  int shown = 0, wrong = 0;
  for (int y = 0; y < job.height_px; ++y) {
    for (int x = 0; x < job.width_px; ++x) {
      const std::size_t n = static_cast<std::size_t>(y * job.width_px + x);
      const Truth truth = pixelTruth(job, x, y, samples);
      const double got = images.values[n];
      const bool data = !std::isnan(truth.value);
      shown += data ? 1 : 0;
      // 6e-8: the value itself is kept as a float.
      const double bound =
          1e-4 * (truth.greatest - truth.least) + 1e-6 * whole + 6e-8 * std::abs(truth.value);
      const bool same = data ? std::abs(got - truth.value) <= bound : std::isnan(got);
      const bool depth = images.depth[n] == (data ? 0.0f : kNothing_mm);
      if ((!same || !depth) && ++wrong <= 3)
        ADD_FAILURE() << what << " pixel " << x << "," << y << ": " << got << ", true " << truth.value
                      << ", bound " << bound << ", depth " << images.depth[n];
    }
  }
  EXPECT_EQ(wrong, 0) << what;
  EXPECT_GT(shown, 0) << what << ": the picture shows nothing, the case tests nothing";
  EXPECT_EQ(images.counters.samples, samples) << what;
}

}  // namespace vernier::test
