// SPDX-License-Identifier: GPL-3.0-or-later
// Slices for the GL techniques' tests, and what they must give: sampleModality (volume's probe in double,
// tested by itself) at each pixel and slab sample, with the local range that bounds the error.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "../volume/Grids.h"
#include "GlForTest.h"
#include "SliceParams.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Voi.h"

namespace vernier::mpr::test {

class GlHost final : public Host {
 public:
  explicit GlHost(gpu::Device* device) : device_(device) {}
  Result<void> addTechnique(Technique) override { return {}; }
  Result<gpu::Device*> glDevice() override {
    if (!device_) return makeError(ErrorCode::GlUnavailable, "No GL in this test.");
    return device_;
  }

 private:
  gpu::Device* device_;
};

// A plane through the volume, turned at random; the volume's border is in the picture.
inline SliceParams randomSlice(std::shared_ptr<const Volume> volume, std::uint64_t seed, int width,
                               int height) {
  const auto unit = [&](std::uint64_t n) { return 2 * randomUnit(seed, n) - 1; };
  const glm::dvec3 normal = glm::normalize(glm::dvec3(unit(0), unit(1), unit(2)));
  const glm::dvec3 right = glm::normalize(glm::cross(normal, glm::dvec3(unit(3), unit(4), unit(5))));
  const GridGeometry& g = volume->grid();
  const double diagonal_mm = glm::length(g.corner(7).p - g.corner(0).p) + g.spacing_mm().x;
  SliceParams p;
  p.view.width_px = width, p.view.height_px = height, p.view.wantValues = true;
  p.picture.mmPerPixel = 0.7 * diagonal_mm / width;
  p.picture.normal = PatientVec(normal);
  p.picture.right = PatientVec(right * p.picture.mmPerPixel);
  p.picture.down = PatientVec(glm::cross(right, normal) * p.picture.mmPerPixel);
  const glm::dvec3 centre = g.centre().p + 0.1 * diagonal_mm * unit(6) * normal;
  p.picture.origin = PatientPoint(centre - 0.5 * width * p.picture.right.v - 0.5 * height * p.picture.down.v);
  p.window = {0, 100, VoiFunction::LinearExact, ""};
  p.background = {0.25, 0.5, 0.75};
  p.volume = std::move(volume);
  return p;
}

// A plane in the volume's own axes: pixel steps along i and j (in voxels), at slice position k.
inline SliceParams alignedSlice(std::shared_ptr<const Volume> volume, glm::dvec3 first_vox,
                                glm::dvec3 right_vox, glm::dvec3 down_vox, int width, int height) {
  SliceParams p;
  const PatientFromVoxel& m = volume->grid().patientFromVoxel;
  p.view.width_px = width, p.view.height_px = height, p.view.wantValues = true;
  p.picture.right = m * VoxelVec(right_vox);
  p.picture.down = m * VoxelVec(down_vox);
  p.picture.normal = normalize(cross(p.picture.right, p.picture.down));
  p.picture.mmPerPixel = length(p.picture.right);
  p.picture.origin = m * VoxelPoint(first_vox) - 0.5 * p.picture.right - 0.5 * p.picture.down;
  p.window = {0, 100, VoiFunction::LinearExact, ""};
  p.volume = std::move(volume);
  return p;
}

inline PatientPoint pointOf(const SliceParams& p, int x, int y, int sample) {
  const double offset_mm = p.slab.thickness_mm * ((sample + 0.5) / p.slabSamples - 0.5);
  return p.picture.origin + (x + 0.5) * p.picture.right + (y + 0.5) * p.picture.down +
         offset_mm * p.picture.normal;
}

struct Truth {
  double value = std::numeric_limits<double>::quiet_NaN();
  double least = std::numeric_limits<double>::infinity(), greatest = -std::numeric_limits<double>::infinity();
  bool border = false;  // so near to where the data end that rounding decides
};

// Least and greatest value of the voxels around a point, padding left out.
inline void widenByVoxels(Truth& t, const Volume& v, PatientPoint point) {
  const GridGeometry& g = v.grid();
  const glm::dvec3 at = (v.voxelFromPatient() * point).p;
  for (std::int64_t k = 0; k < g.slices; ++k) {
    const glm::dvec3 o =
        g.even() ? glm::dvec3(0, 0, static_cast<double>(k)) : g.sliceOrigin_vox[static_cast<std::size_t>(k)];
    const bool lastBelow =
        o.z <= at.z && (k + 1 == g.slices ||
                        (g.even() ? k + 1.0 : g.sliceOrigin_vox[static_cast<std::size_t>(k + 1)].z) > at.z);
    const bool firstAbove =
        o.z > at.z &&
        (k == 0 || (g.even() ? k - 1.0 : g.sliceOrigin_vox[static_cast<std::size_t>(k - 1)].z) <= at.z);
    if (!lastBelow && !firstAbove) continue;
    for (int n = 0; n < 4; ++n) {
      const auto i = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(at.x - o.x)) + (n & 1), 0,
                                              g.columns - 1);
      const auto j = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(at.y - o.y)) + (n >> 1), 0,
                                              g.rows - 1);
      if (v.isNoData(v.stored(i, j, k))) continue;
      t.least = std::min(t.least, v.modality(i, j, k));
      t.greatest = std::max(t.greatest, v.modality(i, j, k));
    }
  }
}

inline Truth truthAt(const SliceParams& p, int x, int y) {
  Truth t;
  double sum = 0;
  int count = 0;
  for (int n = 0; n < p.slabSamples; ++n) {
    const PatientPoint point = pointOf(p, x, y, n);
    const auto value = sampleModality(*p.volume, point, p.interpolation);
    for (int axis = 0; axis < 6; ++axis) {
      glm::dvec3 nudge(0);
      nudge[axis / 2] = axis % 2 ? 3e-6 : -3e-6;
      const PatientPoint beside = point + p.volume->grid().patientFromVoxel * VoxelVec(nudge);
      const auto nudged = sampleModality(*p.volume, beside, p.interpolation);
      // At a face of the data, or of nearest voxels.
      t.border = t.border || nudged.has_value() != value.has_value() ||
                 (p.interpolation == Interpolation::Nearest && value != nudged);
    }
    if (!value) continue;
    widenByVoxels(t, *p.volume, point);
    sum += *value;
    const bool better = count == 0 || (p.slab.mode == SlabMode::Max ? *value > t.value : *value < t.value);
    if (better) t.value = *value;
    ++count;
  }
  if (p.slab.mode == SlabMode::Mean && count > 0) t.value = sum / count;
  return t;
}

struct Compared {
  int withData = 0, withoutData = 0, mismatched = 0, skipped = 0;
  double worst = 0;  // error as a multiple of the allowed one
};

// Compares values with the truth: allowed is perLocal * local range + perStored * range of the volume.
inline Compared compare(const SliceParams& p, const Images& images, double perLocal, double perStored) {
  Compared c;
  const auto range = p.volume->modalityRange();
  const double stored = range ? range->max - range->min : 0;
  for (int y = 0; y < p.view.height_px; ++y)
    for (int x = 0; x < p.view.width_px; ++x) {
      const Truth t = truthAt(p, x, y);
      if (t.border) {
        ++c.skipped;
        continue;
      }
      const auto n = static_cast<std::size_t>(y * p.view.width_px + x);
      const float got = images.values[n];
      if (std::isnan(got) != std::isnan(t.value) || std::isnan(got) != std::isinf(images.depth[n])) {
        ++c.mismatched;
        continue;
      }
      (std::isnan(got) ? c.withoutData : c.withData) += 1;
      if (std::isnan(got)) continue;
      // The float that carries the value out rounds to half a unit in its last place.
      const double rounding = std::abs(t.value) * 6e-8;
      const double allowed = perLocal * (t.greatest - t.least) + perStored * stored + rounding;
      const double error = std::abs(static_cast<double>(got) - t.value);
      c.worst = std::max(c.worst, allowed > 0 ? error / allowed : error > 0 ? 1e9 : 0.0);
    }
  return c;
}

inline constexpr double kFloatLocal = 1e-4, kFloatStored = 1e-6;  // RENDERING 3, slices
inline constexpr double kFixedLocal = 3.0 / 512.0;

inline Pass passOf(const SliceParams& p, bool fixedFunction = false) {
  Pass pass;
  pass.engine = Engine::Gl;
  pass.fixedFunctionFiltering = fixedFunction;
  pass.params = std::make_shared<SliceParams>(p);
  return pass;
}

inline Images drawn(const Technique& technique, const SliceParams& p, bool fixedFunction = false) {
  Images images;
  const Result<void> r = technique.execute(passOf(p, fixedFunction), images, {});
  EXPECT_TRUE(r.ok()) << (r.ok() ? "" : r.error().text());
  return images;
}

inline void expectExact(const Technique& technique, const SliceParams& p, const std::string& what,
                        bool fixedFunction = false) {
  SCOPED_TRACE(what);
  const Images images = drawn(technique, p, fixedFunction);
  ASSERT_EQ(images.values.size(), static_cast<std::size_t>(p.view.width_px * p.view.height_px));
  const Compared c = compare(p, images, fixedFunction ? kFixedLocal : kFloatLocal, kFloatStored);
  EXPECT_EQ(c.mismatched, 0);
  EXPECT_LE(c.worst, 1.0);
  EXPECT_GT(c.withData, 100);
  EXPECT_LT(c.skipped, p.view.width_px * p.view.height_px / 20);
  if (std::getenv("VERNIER_SHOW"))
    std::cout << "  " << what << ": worst " << c.worst << " of the bound, " << c.withData
              << " pixels, skipped " << c.skipped << "\n";
}

template <class T>
std::shared_ptr<const Volume> noiseVolume(const GridGeometry& grid, double low, double high,
                                          ModalityRescale rescale = {},
                                          std::optional<NoDataRange> noData = {}) {
  VolumeInfo info;
  info.grid = grid;
  info.rescale = {rescale};
  info.noData = noData;
  return vernier::test::volumeOf(
      info, vernier::test::randomValues<T>(static_cast<std::size_t>(grid.columns * grid.rows * grid.slices),
                                           7, low, high));
}

}  // namespace vernier::mpr::test
