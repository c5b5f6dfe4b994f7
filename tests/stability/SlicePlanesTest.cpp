// SPDX-License-Identifier: GPL-3.0-or-later
// Extreme cases of slices, C1 to C5: where planes lie. Each technique that can draw here draws them.
#include <cmath>
#include <numbers>

#include "SliceStability.h"
#include "vernier/plan/PictureGeometry.h"
#include "vernier/plan/Presets.h"

namespace vernier {
namespace {

using namespace vernier::test;

// ---- C1 -------------------------------------------------------------------------------------------------

template <class T>
void voxelCentresAreTheStoredValues(double low, double high) {
  const double mm = 0.7;  // not a binary fraction
  const GridGeometry g = boxGrid(24, 20, 16, {mm, mm, mm}, {-103.1, 77.7, -1012.3});
  const auto v = noise<T>(g, low, high);
  const auto expectPicture = [&](const Plane& plane, int width, int height, auto voxelAt) {
    const StabilityCase c = sliceCase(v, plane, width, height, height * mm);
    forEachTechniqueAndCubic(c, [&](const Rendered& r, const std::string& technique) {
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
  StabilityCase c = sliceCase(v, through(kAxial, PatientPoint(15, 15, 12.5)), 30, 30, 30);
  forEachTechniqueAndCubic(c, [&](const Rendered& r, const std::string&) {
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
      const StabilityCase c = sliceCase(v, through(kAxial, PatientPoint(3.5, 3.5, z + e)), 8, 8, 8);
      forEachTechniqueAndCubic(c, [&, k = slice](const Rendered& r, const std::string&) {
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
    StabilityCase c = sliceCase(v, through(kAxial, PatientPoint(3.5, 3.5, z)), 8, 8, 8);
    c.scene.background = Rgb{0.25, 0.5, 0.75};
    forEachTechniqueAndCubic(c, [&](const Rendered& r, const std::string&) {
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
  StabilityCase c;
  c.scene = *scene;
  c.view = View{8, 8, true};
  c.sources.volumes["v"] = v;
  forEachTechniqueAndCubic(c, [&](const Rendered& r, const std::string&) {
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
    StabilityCase straight = sliceCase(v, through(kAxial, PatientPoint(-0.25, -0.25, z)), 64, 64, 32);
    StabilityCase tilted = straight;
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
  StabilityCase c =
      sliceCase(v, Plane{g.centre(), PatientVec(0.2, -0.3, 0.9), PatientVec(0, 1, 0.2)}, 48, 48, 40);
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
  StabilityCase back = c;
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

}  // namespace
}  // namespace vernier
