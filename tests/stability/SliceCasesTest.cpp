// SPDX-License-Identifier: GPL-3.0-or-later
// Extreme cases of slices, C6 to C9: refusals, slabs, thin voxels, the probe. Each technique that can draw
// here draws them.
#include <algorithm>
#include <limits>
#include <optional>

#include "SliceStability.h"
#include "vernier/plan/PictureGeometry.h"
#include "vernier/quality/Badge.h"
#include "vernier/volume/Sampling.h"

namespace vernier {
namespace {

using namespace vernier::test;

// ---- C6 -------------------------------------------------------------------------------------------------

TEST(Stability, C06_DegeneratePlanesAreRefused) {
  const auto v = noise<std::int16_t>(boxGrid(8, 8, 8, {1, 1, 1}), -1000, 1000);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   inf = std::numeric_limits<double>::infinity();
  const std::vector<Plane> planes = {
      {PatientPoint(3, 3, 3), PatientVec(0, 0, 0), PatientVec(0, 1, 0)},
      {PatientPoint(3, 3, 3), PatientVec(0, 0, 1), PatientVec(0, 0, 0)},
      {PatientPoint(3, 3, 3), PatientVec(0, 0, 1), PatientVec(0, 0, -5)},
      {PatientPoint(3, 3, 3), PatientVec(0, 0, 1), PatientVec(0, 1e-8, 1)},
      {PatientPoint(3, 3, 3), PatientVec(0, nan, 1), PatientVec(0, 1, 0)},
      {PatientPoint(3, 3, 3), PatientVec(0, 0, 1), PatientVec(inf, 0, 0)},
      {PatientPoint(3, nan, 3), PatientVec(0, 0, 1), PatientVec(0, 1, 0)},
  };
  for (const Plane& plane : planes) {
    const StabilityCase c = sliceCase(v, plane, 8, 8, 8);
    for (const std::string& technique : sliceTechniques()) {
      const auto r = renderWith(technique, c.scene, c.view, c.sources);
      ASSERT_FALSE(r.ok());
      EXPECT_EQ(r.error().code, ErrorCode::PlaneDegenerate) << r.error().text();
      EXPECT_FALSE(r.error().sentence.empty());
    }
  }
  // Tiny and huge vectors are no reason: only directions count.
  const StabilityCase fine = sliceCase(
      v, Plane{PatientPoint(3.5, 3.5, 3), PatientVec(0, 0, -1e-200), PatientVec(0, -1e200, 0)}, 8, 8, 8);
  forEachTechnique(fine, [&](const Rendered& r, const std::string&) {
    EXPECT_NEAR(valueOf(r, 2, 5), v->modality(2, 5, 3), allowed(r, 2000, 2000));
  });
}

// ---- C7 -------------------------------------------------------------------------------------------------

TEST(Stability, C07_SlabsOfNoThicknessOfAHairAndOfEverything) {
  const GridGeometry g = boxGrid(16, 16, 12, {1, 1, 2}, {0, 0, 40});
  const auto v = noise<std::int16_t>(g, -1000, 1000);
  const PatientPoint middle = g.centre();  // between slices 5 and 6
  for (const std::string& technique : sliceTechniques()) {
    SCOPED_TRACE(technique);
    const auto draw = [&](double thickness, SlabMode mode, double step = 1) {
      StabilityCase c = sliceCase(v, through(kAxial, middle), 16, 16, 16);
      c.layer().slab = Slab{thickness, mode};
      auto r = renderWith(technique, c.scene, c.view, c.sources, step);
      // GL may have no room for so many samples; it says so.
      const bool refused = !r && technique != "mpr.native" && r.error().code == ErrorCode::NoTechnique;
      EXPECT_TRUE(r.ok() || refused) << r.error().text();
      return r.ok() ? std::optional(*r) : std::nullopt;
    };
    const auto single = draw(0, SlabMode::Max), other = draw(0, SlabMode::Mean);
    ASSERT_TRUE(single && other);
    ASSERT_EQ(single->frame.images.values, other->frame.images.values);
    const double tolerance = allowed(*single, 2000, 2000);
    // A hair: one sample in the middle, the slice itself.
    const auto hair = draw(1e-9, SlabMode::Max), thin = draw(0.5, SlabMode::Max);
    ASSERT_TRUE(hair && thin);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        ASSERT_NEAR(valueOf(*hair, x, y), valueOf(*single, x, y), tolerance);
        ASSERT_NEAR(valueOf(*thin, x, y), valueOf(*single, x, y), tolerance);
      }
    // Exactly the volume, a sample at each half slice: extrema within half a step of the columns' own; far
    // more than the volume: the same, as what lies outside counts for nothing.
    for (double thickness : {24.0, 1000.0})
      for (SlabMode mode : {SlabMode::Max, SlabMode::Min, SlabMode::Mean}) {
        const auto whole = draw(thickness, mode, thickness == 24 ? 1.0 / 32 : 0.25);
        if (!whole) continue;
        for (int y = 0; y < 16; ++y)
          for (int x = 0; x < 16; ++x) {
            double max = -1e9, min = 1e9, sum = 0;
            for (int k = 0; k < 12; ++k) {
              const double m = v->modality(x, y, k);
              max = std::max(max, m), min = std::min(min, m), sum += m;
            }
            const double truth = mode == SlabMode::Max ? max : mode == SlabMode::Min ? min : sum / 12;
            // Between two samples of a ramp of at most 2000 over 2 mm.
            const double missed = thickness == 24 ? 2000.0 / 64 : 2000.0 / 8;
            ASSERT_NEAR(valueOf(*whole, x, y), truth, missed + tolerance)
                << thickness << " " << x << "," << y;
          }
      }
    // One sample a slice, at the slices: the projection of the stored values, exactly.
    const auto exact = draw(24, SlabMode::Max, 2);
    ASSERT_TRUE(exact);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        double max = -1e9;
        for (int k = 0; k < 12; ++k) max = std::max(max, v->modality(x, y, k));
        ASSERT_NEAR(valueOf(*exact, x, y), max, tolerance);
      }
  }
  // Negative and infinite thickness are refused, not drawn as something else.
  for (double bad :
       {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    StabilityCase c = sliceCase(v, through(kAxial, middle), 16, 16, 16);
    c.layer().slab.thickness_mm = bad;
    EXPECT_FALSE(renderWith("mpr.native", c.scene, c.view, c.sources).ok()) << bad;
  }
}

// ---- C8 -------------------------------------------------------------------------------------------------

TEST(Stability, C08_ObliqueThroughOneToFiftyVoxels) {
  const GridGeometry g = boxGrid(96, 96, 8, {0.2, 0.2, 10}, {-10, 5, -700});
  const auto v = noise<std::int16_t>(g, -1000, 1000);
  StabilityCase c = sliceCase(v, Plane{g.centre(), PatientVec(0, 1, 1), PatientVec(0, -1, 1)}, 128, 128, 24);
  quality::ErrorOptions all;
  all.samples = 128 * 128;
  forEachTechnique(c, [&](const Rendered& r, const std::string&) {
    const auto e = quality::measureError(r.frame, c.scene, c.view, c.sources, all);
    ASSERT_TRUE(e.ok());
    ASSERT_TRUE(e->exhaustive);
    ASSERT_GT(e->n, 1000u);
    ASSERT_TRUE(e->values);
    EXPECT_EQ(e->values->coverageDiffersInside, 0u);
    // A level of 255 over the window of 2000.
    EXPECT_LE(e->values->max_val * 255 / 2000, r.fixedFunction ? 3.0 / 512 * 255 : 0.25);
    if (!r.fixedFunction) {
      EXPECT_LE(*e->bound, 0.25);
    }
  });
}

// ---- C9 -------------------------------------------------------------------------------------------------

TEST(Stability, C09_TheProbeReadsTheSameInThreeViews) {
  for (const NamedGrid& named : everyGrid()) {
    SCOPED_TRACE(named.name);
    VolumeInfo info;
    info.grid = named.grid;
    const auto v = volumeOf<std::int16_t>(info, randomValues<std::int16_t>(7 * 6 * 9, 5, -1000, 1000));
    const double whole = v->modalityRange()->max - v->modalityRange()->min;
    for (std::uint64_t trial = 0; trial < 10; ++trial) {
      const VoxelPoint q(6 * randomUnit(trial, 0), 5 * randomUnit(trial, 1), 8 * randomUnit(trial, 2));
      const PatientPoint p = named.grid.patientFromVoxel * q;
      const auto truth = sampleModality(*v, p);
      for (const Plane& preset : {kAxial, kCoronal, kSagittal}) {
        // The crosshair's point is a pixel's centre: the middle of a picture of odd size.
        StabilityCase c = sliceCase(v, through(preset, p), 9, 9, 4);
        const auto picture = slicePicture(c.layer(), c.scene.camera, c.view, *v);
        ASSERT_TRUE(picture.ok());
        const PatientPoint shown = picture->origin + 4.5 * picture->right + 4.5 * picture->down;
        const auto probe = sampleModality(*v, shown);
        ASSERT_EQ(probe.has_value(), truth.has_value());
        if (truth) {
          ASSERT_NEAR(*probe, *truth, 1e-9);
        }
        forEachTechnique(c, [&](const Rendered& r, const std::string&) {
          const float drawn = valueOf(r, 4, 4);
          ASSERT_EQ(std::isnan(drawn), !truth.has_value());
          if (truth) {
            ASSERT_NEAR(drawn, *truth, allowed(r, whole, whole));
          }
        });
      }
    }
  }
}

}  // namespace
}  // namespace vernier
