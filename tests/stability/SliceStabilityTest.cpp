// SPDX-License-Identifier: GPL-3.0-or-later
// Extreme cases of slices, C1 to C9, for each technique that can draw here.
#include <cmath>
#include <limits>
#include <numbers>

#include "../unit/volume/Grids.h"
#include "RenderForTest.h"
#include "vernier/plan/PictureGeometry.h"
#include "vernier/plan/Presets.h"
#include "vernier/quality/Badge.h"
#include "vernier/volume/Sampling.h"

namespace vernier {
namespace {

using namespace vernier::test;

GridGeometry boxGrid(std::int64_t columns, std::int64_t rows, std::int64_t slices, glm::dvec3 spacing,
                     glm::dvec3 origin = glm::dvec3(0)) {
  GridGeometry g = unitGrid(columns, rows, slices);
  for (int n = 0; n < 3; ++n) g.patientFromVoxel.linear[n][n] = spacing[n];
  g.patientFromVoxel.translation = origin;
  return g;
}

template <class T>
std::shared_ptr<const Volume> noise(GridGeometry grid, double low, double high) {
  VolumeInfo info;
  info.grid = std::move(grid);
  const auto n = static_cast<std::size_t>(info.grid.columns * info.grid.rows * info.grid.slices);
  return volumeOf<T>(std::move(info), randomValues<T>(n, 11, low, high));
}

struct Case {
  Scene scene;
  View view;
  Sources sources;
  SliceLayer& layer() { return std::get<SliceLayer>(scene.layers[0]); }
};

Case sliceCase(std::shared_ptr<const Volume> volume, Plane plane, int width, int height, double height_mm) {
  Case c;
  SliceLayer layer;
  layer.source = "v";
  layer.plane = plane;
  layer.window = VoiWindow{0, 2000, VoiFunction::LinearExact, ""};
  c.scene.layers.emplace_back(layer);
  c.scene.camera.height_mm = height_mm;
  c.view = View{width, height, true};
  c.sources.volumes["v"] = std::move(volume);
  return c;
}

// Draws with each technique in turn; `check` gets what it drew. Native must draw, GL may refuse.
template <class Check>
void forEachTechnique(const Case& c, Check&& check) {
  for (const std::string& technique : sliceTechniques()) {
    SCOPED_TRACE(technique);
    const auto r = renderWith(technique, c.scene, c.view, c.sources);
    if (!r && technique != "mpr.native" && r.error().code == ErrorCode::NoTechnique) continue;
    ASSERT_TRUE(r.ok()) << r.error().text();
    check(*r, technique);
  }
}

// What a technique may differ from double by, in modality units, where the voxels used span `local`.
double allowed(const Rendered& r, double local, double whole) {
  return (r.fixedFunction ? 3.0 / 512 : 1e-4) * local + 1e-6 * whole;
}

const Plane kAxial{{}, PatientVec(0, 0, -1), PatientVec(0, -1, 0)};
const Plane kCoronal{{}, PatientVec(0, -1, 0), PatientVec(0, 0, 1)};
const Plane kSagittal{{}, PatientVec(1, 0, 0), PatientVec(0, 0, 1)};

Plane through(Plane plane, PatientPoint p) {
  plane.point = p;
  return plane;
}

// ---- C1 -------------------------------------------------------------------------------------------------

template <class T>
void voxelCentresAreTheStoredValues(double low, double high) {
  const double mm = 0.7;  // not a binary fraction
  const GridGeometry g = boxGrid(24, 20, 16, {mm, mm, mm}, {-103.1, 77.7, -1012.3});
  const auto v = noise<T>(g, low, high);
  const auto expectPicture = [&](const Plane& plane, int width, int height, auto voxelAt) {
    const Case c = sliceCase(v, plane, width, height, height * mm);
    forEachTechnique(c, [&](const Rendered& r, const std::string& technique) {
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const glm::ivec3 q = voxelAt(x, y);
          const auto stored = static_cast<float>(v->modality(q.x, q.y, q.z));
          if (technique == "mpr.native") {
            ASSERT_EQ(valueOf(r, x, y), stored) << x << "," << y;
          } else {
            ASSERT_NEAR(valueOf(r, x, y), stored, allowed(r, high - low, high - low)) << x << "," << y;
          }
        }
    });
  };
  const glm::dvec3 centre = g.centre().p;
  const auto at = [&](int axis, int index) {
    glm::dvec3 p = centre;
    p[axis] = g.patientFromVoxel.translation[axis] + index * mm;
    return PatientPoint(p);
  };
  for (int k : {0, 7, 15})
    expectPicture(through(kAxial, at(2, k)), 24, 20, [&](int x, int y) { return glm::ivec3(x, y, k); });
  for (int j : {0, 9, 19})
    expectPicture(through(kCoronal, at(1, j)), 24, 16,
                  [&](int x, int y) { return glm::ivec3(x, j, 15 - y); });
  for (int i : {0, 11, 23})
    expectPicture(through(kSagittal, at(0, i)), 20, 16,
                  [&](int x, int y) { return glm::ivec3(i, x, 15 - y); });
}

TEST(Stability, C01_AxisAlignedAtVoxelCentresIsTheSourceSliceI16) {
  voxelCentresAreTheStoredValues<std::int16_t>(-32768, 32767);
}
TEST(Stability, C01_AxisAlignedAtVoxelCentresIsTheSourceSliceU16) {
  voxelCentresAreTheStoredValues<std::uint16_t>(0, 65535);
}
TEST(Stability, C01_AxisAlignedAtVoxelCentresIsTheSourceSliceU8) {
  voxelCentresAreTheStoredValues<std::uint8_t>(0, 255);
}
TEST(Stability, C01_AxisAlignedAtVoxelCentresIsTheSourceSliceF32) {
  voxelCentresAreTheStoredValues<float>(-1.0, 1.0);
}

// ---- C2 -------------------------------------------------------------------------------------------------

TEST(Stability, C02_HalfVoxelShiftOfALinearRampIsExact) {
  const GridGeometry g = boxGrid(32, 32, 32, {1, 1, 1});
  VolumeInfo info;
  info.grid = g;
  std::vector<std::int16_t> values;
  for (int k = 0; k < 32; ++k)
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 32; ++i) values.push_back(static_cast<std::int16_t>(4 * i + 20 * j + 100 * k));
  const auto v = volumeOf<std::int16_t>(info, values);
  const double range = 124 * 31;
  // Pixels at i + 0.5, j + 0.5 and the plane at k + 0.5.
  Case c = sliceCase(v, through(kAxial, PatientPoint(15, 15, 12.5)), 30, 30, 30);
  forEachTechnique(c, [&](const Rendered& r, const std::string&) {
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 30; ++x) {
        const double truth = 4 * (x + 0.5) + 20 * (y + 0.5) + 100 * 12.5;
        const double tolerance = r.fixedFunction ? (4 + 20 + 100) / 512.0 : 1e-6 * range;
        ASSERT_NEAR(valueOf(r, x, y), truth, tolerance) << x << "," << y;
      }
  });
}

// ---- C3 -------------------------------------------------------------------------------------------------

TEST(Stability, C03_PlanesOnTheFirstAndLastFaceAreIncluded) {
  const GridGeometry g = boxGrid(8, 8, 5, {1, 1, 3}, {0, 0, -6});
  const auto v = noise<std::int16_t>(g, -1000, 1000);
  for (double e : {-7e-15, 0.0, 7e-15}) {
    for (const auto& [z, slice] :
         std::vector<std::pair<double, int>>{{-6.0, 0}, {6.0, 4}, {-7.5, 0}, {7.5, 4}}) {
      SCOPED_TRACE("z " + std::to_string(z) + " e " + std::to_string(e * 1e15));
      const Case c = sliceCase(v, through(kAxial, PatientPoint(3.5, 3.5, z + e)), 8, 8, 8);
      forEachTechnique(c, [&, k = slice](const Rendered& r, const std::string&) {
        for (int y = 0; y < 8; ++y)
          for (int x = 0; x < 8; ++x)
            ASSERT_NEAR(valueOf(r, x, y), v->modality(x, y, k), allowed(r, 2000, 2000)) << x << "," << y;
      });
    }
  }
}

TEST(Stability, C03_BeyondHalfAVoxelIsBackground) {
  const GridGeometry g = boxGrid(8, 8, 5, {1, 1, 3}, {0, 0, -6});
  const auto v = noise<std::int16_t>(g, -1000, 1000);
  for (double z : {-7.5 - 3e-3, 7.5 + 3e-3, 40.0}) {
    Case c = sliceCase(v, through(kAxial, PatientPoint(3.5, 3.5, z)), 8, 8, 8);
    c.scene.background = Rgb{0.25, 0.5, 0.75};
    forEachTechnique(c, [&](const Rendered& r, const std::string&) {
      for (std::size_t n = 0; n < 64; ++n) {
        ASSERT_TRUE(std::isnan(r.frame.images.values[n])) << z;
        ASSERT_EQ(r.frame.images.colour[4 * n + 0], 0.25f);
        ASSERT_EQ(r.frame.images.colour[4 * n + 1], 0.5f);
        ASSERT_EQ(r.frame.images.colour[4 * n + 2], 0.75f);
      }
    });
  }
}

TEST(Stability, C03_ASingleSliceIsNotLost) {
  const auto v = noise<std::int16_t>(boxGrid(8, 8, 1, {1, 1, 3}, {0, 0, 100.1}), -1000, 1000);
  const auto scene = presetScene("axial", "v", *v, {});
  ASSERT_TRUE(scene.ok());
  Case c;
  c.scene = *scene;
  c.view = View{8, 8, true};
  c.sources.volumes["v"] = v;
  forEachTechnique(c, [&](const Rendered& r, const std::string&) {
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) ASSERT_NEAR(valueOf(r, x, y), v->modality(x, y, 0), allowed(r, 2000, 2000));
  });
}

// ---- C4 -------------------------------------------------------------------------------------------------

TEST(Stability, C04_ATinyTiltChangesNothing) {
  const GridGeometry g = boxGrid(64, 64, 32, {0.5, 0.5, 1}, {-16, -16, -900});
  const auto v = noise<std::int16_t>(g, -1000, 1000);
  const double tilt = 1e-7 * std::numbers::pi / 180;
  for (double z : {-900.0, -885.0, -869.0}) {
    Case straight = sliceCase(v, through(kAxial, PatientPoint(-0.25, -0.25, z)), 64, 64, 32);
    Case tilted = straight;
    tilted.layer().plane.normal = PatientVec(0, std::sin(tilt), -std::cos(tilt));
    tilted.layer().plane.up = PatientVec(0, -std::cos(tilt), -std::sin(tilt));
    for (const std::string& technique : sliceTechniques()) {
      SCOPED_TRACE(technique);
      const auto a = renderWith(technique, straight.scene, straight.view, straight.sources);
      const auto b = renderWith(technique, tilted.scene, tilted.view, tilted.sources);
      ASSERT_TRUE(a.ok() && b.ok());
      for (std::size_t n = 0; n < 64 * 64; ++n) {
        ASSERT_FALSE(std::isnan(a->frame.images.values[n])) << "dropped at " << n;
        ASSERT_FALSE(std::isnan(b->frame.images.values[n])) << "dropped at " << n;
        ASSERT_NEAR(a->frame.images.colour[4 * n], b->frame.images.colour[4 * n], 1.0 / 255);
      }
    }
  }
}

// ---- C5 -------------------------------------------------------------------------------------------------

glm::dvec3 turned(glm::dvec3 v, glm::dvec3 axis, double angle) {
  return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) +
         axis * glm::dot(axis, v) * (1 - std::cos(angle));
}

TEST(Stability, C05_AFullTurnIn3600StepsComesBack) {
  const GridGeometry g = boxGrid(32, 32, 32, {1, 1, 1}, {-15.5, -15.5, 500});
  const auto v = noise<std::int16_t>(g, -1000, 1000);
  Case c = sliceCase(v, Plane{g.centre(), PatientVec(0.2, -0.3, 0.9), PatientVec(0, 1, 0.2)}, 48, 48, 40);
  Plane plane = c.layer().plane;
  const glm::dvec3 axis = glm::normalize(glm::dvec3(0.3, 0.8, -0.5));
  for (int step = 0; step < 3600; ++step) {
    plane.normal.v = turned(plane.normal.v, axis, 2 * std::numbers::pi / 3600);
    plane.up.v = turned(plane.up.v, axis, 2 * std::numbers::pi / 3600);
    SliceLayer layer = c.layer();
    layer.plane = plane;
    const auto picture = slicePicture(layer, c.scene.camera, c.view, *v);
    ASSERT_TRUE(picture.ok());
    const glm::dvec3 right = picture->right.v / picture->mmPerPixel,
                     down = picture->down.v / picture->mmPerPixel, normal = picture->normal.v;
    ASSERT_NEAR(glm::dot(right, down), 0, 1e-9);
    ASSERT_NEAR(glm::dot(right, normal), 0, 1e-9);
    ASSERT_NEAR(glm::length(right), 1, 1e-9);
    ASSERT_NEAR(glm::length(down), 1, 1e-9);
    ASSERT_NEAR(glm::dot(glm::cross(right, -down), normal), 1, 1e-9);  // right-handed, never mirrored
  }
  Case back = c;
  back.layer().plane = plane;
  for (const std::string& technique : sliceTechniques()) {
    SCOPED_TRACE(technique);
    const auto a = renderWith(technique, c.scene, c.view, c.sources);
    const auto b = renderWith(technique, back.scene, back.view, back.sources);
    ASSERT_TRUE(a.ok() && b.ok());
    for (std::size_t n = 0; n < a->frame.images.values.size(); ++n) {
      const float before = a->frame.images.values[n], after = b->frame.images.values[n];
      ASSERT_EQ(std::isnan(before), std::isnan(after)) << n;
      if (!std::isnan(before)) {
        ASSERT_NEAR(before, after, a->fixedFunction ? 2000 / 256.0 : 2000 * 1e-4) << n;
      }
    }
  }
}

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
    const Case c = sliceCase(v, plane, 8, 8, 8);
    for (const std::string& technique : sliceTechniques()) {
      const auto r = renderWith(technique, c.scene, c.view, c.sources);
      ASSERT_FALSE(r.ok());
      EXPECT_EQ(r.error().code, ErrorCode::PlaneDegenerate) << r.error().text();
      EXPECT_FALSE(r.error().sentence.empty());
    }
  }
  // Tiny and huge vectors are no reason: only directions count.
  const Case fine = sliceCase(
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
      Case c = sliceCase(v, through(kAxial, middle), 16, 16, 16);
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
    Case c = sliceCase(v, through(kAxial, middle), 16, 16, 16);
    c.layer().slab.thickness_mm = bad;
    EXPECT_FALSE(renderWith("mpr.native", c.scene, c.view, c.sources).ok()) << bad;
  }
}

// ---- C8 -------------------------------------------------------------------------------------------------

TEST(Stability, C08_ObliqueThroughOneToFiftyVoxels) {
  const GridGeometry g = boxGrid(96, 96, 8, {0.2, 0.2, 10}, {-10, 5, -700});
  const auto v = noise<std::int16_t>(g, -1000, 1000);
  Case c = sliceCase(v, Plane{g.centre(), PatientVec(0, 1, 1), PatientVec(0, -1, 1)}, 128, 128, 24);
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
        Case c = sliceCase(v, through(preset, p), 9, 9, 4);
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
