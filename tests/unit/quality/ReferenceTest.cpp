// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/quality/Reference.h"

#include <cmath>
#include <limits>

#include "Scenes.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const double kSqrt2 = std::sqrt(2.0);

double along(const VoxelFunction& f, glm::dvec3 a, glm::dvec3 b, SlabMode mode) {
  const auto v = valueAlong(floatVolume(gridOf(2, 2, 2), f), a, b, mode);
  return v ? v->value : kNan;
}

// ---- closed forms of one cell ---------------------------------------------------------------------------

TEST(CellClosedForm, CubicOnTheDiagonal) {
  // x y z along (0,0,0)..(1,1,1) is u^3.
  const VoxelFunction f = [](auto i, auto j, auto k) { return static_cast<double>(i * j * k); };
  EXPECT_NEAR(along(f, {0, 0, 0}, {1, 1, 1}, SlabMode::Max), 1.0, 1e-14);
  EXPECT_NEAR(along(f, {0, 0, 0}, {1, 1, 1}, SlabMode::Min), 0.0, 1e-14);
  EXPECT_NEAR(along(f, {0, 0, 0}, {1, 1, 1}, SlabMode::Mean), 0.25, 1e-14);
}

TEST(CellClosedForm, QuadraticWithItsMaximumInside) {
  // x y along x = u, y = 1 - u is u (1 - u): both ends 0, 1/4 in the middle.
  const VoxelFunction f = [](auto i, auto j, auto) { return static_cast<double>(i * j); };
  EXPECT_NEAR(along(f, {0, 1, 0.5}, {1, 0, 0.5}, SlabMode::Max), 0.25, 1e-14);
  EXPECT_NEAR(along(f, {0, 1, 0.5}, {1, 0, 0.5}, SlabMode::Min), 0.0, 1e-14);
  EXPECT_NEAR(along(f, {0, 1, 0.5}, {1, 0, 0.5}, SlabMode::Mean), 1.0 / 6, 1e-14);
}

TEST(CellClosedForm, CubicWithItsMaximumInside) {
  // x y (1 - z) along u: u^2 (1 - u), greatest 4/27 at u = 2/3, mean 1/12.
  const VoxelFunction f = [](auto i, auto j, auto k) { return static_cast<double>(i * j * (1 - k)); };
  EXPECT_NEAR(along(f, {0, 0, 0}, {1, 1, 1}, SlabMode::Max), 4.0 / 27, 1e-14);
  EXPECT_NEAR(along(f, {0, 0, 0}, {1, 1, 1}, SlabMode::Mean), 1.0 / 12, 1e-14);
  const VoxelFunction negative = [&](auto i, auto j, auto k) { return -f(i, j, k); };
  EXPECT_NEAR(along(negative, {0, 0, 0}, {1, 1, 1}, SlabMode::Min), -4.0 / 27, 1e-14);
}

TEST(CellClosedForm, SamplesMissWhatTheTruthFinds) {
  // One midpoint sample of u (1 - u) hits the maximum, two miss it by 1/16: a model error, not one of
  // arithmetic.
  const auto v =
      floatVolume(gridOf(2, 2, 2), [](auto i, auto j, auto) { return static_cast<double>(i * j); });
  ReferenceOptions options{ErrorKind::Implementation, 1};
  EXPECT_EQ(slabSamples(*v, kSqrt2, 1), 2);
  EXPECT_NEAR(valueAlong(v, {0, 1, 0.5}, {1, 0, 0.5}, SlabMode::Max, Interpolation::Linear, options)->value,
              3.0 / 16, 1e-14);
  options.kind = ErrorKind::Model;
  EXPECT_NEAR(valueAlong(v, {0, 1, 0.5}, {1, 0, 0.5}, SlabMode::Max, Interpolation::Linear, options)->value,
              0.25, 1e-14);
  EXPECT_EQ(slabSamples(*v, 0, 1), 1);
  EXPECT_EQ(slabSamples(*v, 10, 0.5), 20);
}

// ---- whole volumes --------------------------------------------------------------------------------------

TEST(SliceReference, ConstantIsConstantUpToTheBorder) {
  const auto v = floatVolume(gridOf(4, 5, 6, {0.7, 1.1, 3}), [](auto, auto, auto) { return 7.0; });
  for (double f : {-0.5, -0.2, 0.0, 0.3, 1.7, 3.5})
    EXPECT_EQ(valueAt(v, PatientPoint(f * 0.7, 1.1, 3))->value, 7.0) << f;
  EXPECT_FALSE(valueAt(v, PatientPoint(-0.501 * 0.7, 1.1, 3)));
  EXPECT_FALSE(valueAt(v, PatientPoint(3.501 * 0.7, 1.1, 3)));
  EXPECT_FALSE(valueAt(v, PatientPoint(0, 0, 5.51 * 3)));
}

TEST(SliceReference, LinearRampsAreExactOnAnyPlane) {
  GridGeometry g = gridOf(9, 8, 7);
  // Oblique, sheared and left-handed.
  g.patientFromVoxel.linear = glm::dmat3(0.6, 0.2, 0.0, -0.3, 0.9, 0.1, 0.4, 0.1, -2.0);
  g.patientFromVoxel.translation = {-40, 12, 1000};
  const auto v =
      floatVolume(g, [](auto i, auto j, auto k) { return static_cast<double>(3 * i - 5 * j + 11 * k); });
  SliceScene s = sliceScene(v, Plane{g.centre(), PatientVec(0.3, -0.4, 0.7), PatientVec(0.1, 1, 0)}, 16, 2.5);
  std::vector<std::size_t> all(256);
  for (std::size_t n = 0; n < all.size(); ++n) all[n] = n;
  const auto pixels = referencePixels(s.scene, s.view, s.sources, all);
  ASSERT_TRUE(pixels.ok());
  // The picture's axes, worked out here by hand.
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.3, -0.4, 0.7));
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0.1, 1, 0), n)), up = glm::cross(n, right);
  for (std::size_t y = 0; y < 16; ++y)
    for (std::size_t x = 0; x < 16; ++x) {
      const double mm = 2.5 / 16;
      const glm::dvec3 p = g.centre().p + (static_cast<double>(x) - 7.5) * mm * right -
                           (static_cast<double>(y) - 7.5) * mm * up;
      const glm::dvec3 q = (g.patientFromVoxel.inverse() * PatientPoint(p)).p;
      EXPECT_NEAR((*pixels)[x + 16 * y].value, 3 * q.x - 5 * q.y + 11 * q.z, 1e-10);
    }
}

TEST(SliceReference, VoxelCentresAreBitEqual) {
  const auto v = floatVolume(
      gridOf(3, 3, 3), [](auto i, auto j, auto k) { return 0.1 * static_cast<double>(i + 3 * j + 9 * k); });
  EXPECT_EQ(valueAt(v, PatientPoint(1, 2, 1))->value, v->modality(1, 2, 1));
  EXPECT_EQ(valueAt(v, PatientPoint(1, 2, 1), Interpolation::Nearest)->value, v->modality(1, 2, 1));
  EXPECT_EQ(valueAt(v, PatientPoint(1.49, 1.51, 0.6), Interpolation::Nearest)->value, v->modality(1, 2, 1));
}

TEST(SliceReference, BorderIsHeldForHalfAVoxelAlongASlab) {
  // One slice of value 5: the field reaches from -0.5 to 0.5 mm; a 10 mm slab averages over the valid
  // millimetre only.
  const auto v = floatVolume(gridOf(3, 3, 1), [](auto, auto, auto) { return 5.0; });
  EXPECT_NEAR(valueAlong(v, {1, 1, -5}, {1, 1, 5}, SlabMode::Mean)->value, 5, 1e-14);
  // A ramp 0, 1 held at both ends: (0.5 * 0 + 0.5 + 0.5 * 1) / 2.
  const auto ramp = floatVolume(gridOf(1, 1, 2), [](auto, auto, auto k) { return static_cast<double>(k); });
  EXPECT_NEAR(valueAlong(ramp, {0, 0, -9}, {0, 0, 9}, SlabMode::Mean)->value, 0.5, 1e-14);
  EXPECT_NEAR(valueAlong(ramp, {0, 0, 0}, {0, 0, 9}, SlabMode::Mean)->value, (0.5 + 0.5) / 1.5, 1e-14);
  EXPECT_FALSE(valueAlong(ramp, {0, 0, 2}, {0, 0, 9}, SlabMode::Mean));
}

TEST(SliceReference, NearestSlabIsCutAtVoxelFaces) {
  const auto v = floatVolume(gridOf(1, 1, 3), [](auto, auto, auto k) { return static_cast<double>(k * k); });
  // From -0.5 to 1.0: one mm of 0, half a mm of 1.
  EXPECT_NEAR(valueAlong(v, {0, 0, -0.5}, {0, 0, 1}, SlabMode::Mean, Interpolation::Nearest)->value,
              0.5 / 1.5, 1e-14);
  EXPECT_EQ(valueAlong(v, {0, 0, -0.5}, {0, 0, 1.4}, SlabMode::Max, Interpolation::Nearest)->value, 1);
  EXPECT_EQ(valueAlong(v, {0, 0, -0.5}, {0, 0, 1.6}, SlabMode::Max, Interpolation::Nearest)->value, 4);
}

TEST(SliceReference, LocalRangeIsThatOfTheCell) {
  const auto v = floatVolume(
      gridOf(4, 4, 4), [](auto i, auto j, auto k) { return static_cast<double>(i + 10 * j + 100 * k); });
  const auto r = valueAt(v, PatientPoint(1.5, 2.5, 0.5));
  EXPECT_EQ(r->localMin, 21);
  EXPECT_EQ(r->localMax, 132);
}

// ---- no-data, uneven slices, gaps -----------------------------------------------------------------------

TEST(SliceReference, NoDataIsRenormalisedOverValidCorners) {
  VolumeInfo info;
  info.grid = gridOf(2, 2, 1);
  info.noData = NoDataRange{-3000, -2000};
  // Corners 0, 10 / 20, padding.
  const auto v = floatVolume(
      info, [](auto i, auto j, auto) { return i && j ? -2000.0 : 10.0 * static_cast<double>(i + 2 * j); });
  // At (0.25, 0.5): weights 3/8, 1/8, 3/8 of the valid ones.
  EXPECT_NEAR(valueAt(v, PatientPoint(0.25, 0.5, 0))->value, (10 * 0.125 + 20 * 0.375) / 0.875, 1e-14);
  EXPECT_EQ(valueAt(v, PatientPoint(0.25, 0.5, 0))->localMax, 20);
  EXPECT_FALSE(valueAt(v, PatientPoint(1, 1, 0)));
  EXPECT_FALSE(valueAt(v, PatientPoint(1 - 1e-12, 1, 0)));
  EXPECT_FALSE(valueAt(v, PatientPoint(1.4, 1.4, 0)));
  EXPECT_FALSE(valueAt(v, PatientPoint(0.6, 0.6, 0), Interpolation::Nearest));
  EXPECT_EQ(valueAt(v, PatientPoint(0.6, 0.4, 0), Interpolation::Nearest)->value, 10);
  // Along the diagonal from the valid corner towards the padding: (10 + 20) u (1-u) / (1 - u^2) = 30 u / (1 +
  // u); it rises to 15 where the weight vanishes.
  EXPECT_NEAR(valueAlong(v, {0, 0, 0}, {1, 1, 0}, SlabMode::Max)->value, 15, 5e-6);
  EXPECT_NEAR(valueAlong(v, {0, 0, 0}, {1, 1, 0}, SlabMode::Mean)->value, 30 * (1 - std::log(2.0)), 1e-9);
  // Beyond the padding voxel's centre there is nothing but itself.
  EXPECT_NEAR(valueAlong(v, {0, 0, 0}, {1.5, 1.5, 0}, SlabMode::Mean)->value, 30 * (1 - std::log(2.0)), 1e-9);
}

TEST(SliceReference, NanVoxelsAreNoData) {
  const auto v = floatVolume(gridOf(3, 1, 1),
                             [](auto i, auto, auto) { return i == 1 ? kNan : 4.0 + static_cast<double>(i); });
  EXPECT_EQ(valueAt(v, PatientPoint(0.9, 0, 0))->value, 4);
  EXPECT_EQ(valueAt(v, PatientPoint(1.1, 0, 0))->value, 6);
  EXPECT_FALSE(valueAt(v, PatientPoint(1, 0, 0)));
  EXPECT_EQ(valueAlong(v, {-0.5, 0, 0}, {2.5, 0, 0}, SlabMode::Max)->value, 6);
  EXPECT_NEAR(valueAlong(v, {-0.5, 0, 0}, {2.5, 0, 0}, SlabMode::Mean)->value, 5, 1e-12);
}

GridGeometry unevenGrid() {
  GridGeometry g = gridOf(2, 2, 4);
  // Slices at 0, 0.8, 2 and, after a gap, 5; the second shifted by 0.25 in x.
  g.sliceOrigin_vox = {{0, 0, 0}, {0.25, 0, 0.8}, {0, 0, 2}, {0, 0, 5}};
  g.gapAfter = {2};
  return g;
}

TEST(SliceReference, UnevenSlicesAreInterpolatedWhereTheyAre) {
  const auto v =
      floatVolume(unevenGrid(), [](auto i, auto, auto k) { return static_cast<double>(100 * k + 10 * i); });
  // Between slices 0 and 1 at z = 0.4: half of each; x = 0.5 lies at 0.5 of slice 0 and 0.25 of slice 1.
  EXPECT_NEAR(valueAt(v, PatientPoint(0.5, 0, 0.4))->value, 0.5 * 5 + 0.5 * (100 + 2.5), 1e-12);
  EXPECT_NEAR(valueAt(v, PatientPoint(0.5, 0, 1.4))->value, 0.5 * (100 + 2.5) + 0.5 * (200 + 5), 1e-12);
  // x = -0.4: inside the border of slice 0, outside that of slice 1 (which begins at -0.25).
  EXPECT_NEAR(valueAt(v, PatientPoint(-0.4, 0, 0.4))->value, 0, 1e-12);
  EXPECT_FALSE(valueAt(v, PatientPoint(-0.4, 0, 0.8)));
  EXPECT_EQ(valueAt(v, PatientPoint(1, 0, 1.2), Interpolation::Nearest)->value, 110);
  EXPECT_EQ(valueAt(v, PatientPoint(1, 0, 1.5), Interpolation::Nearest)->value, 210);
}

TEST(SliceReference, NothingIsInterpolatedAcrossAGap) {
  const auto v = floatVolume(unevenGrid(), [](auto, auto, auto k) { return static_cast<double>(100 * k); });
  EXPECT_EQ(valueAt(v, PatientPoint(0, 0, 2.4))->value, 200);
  EXPECT_EQ(valueAt(v, PatientPoint(0, 0, 2.5))->value, 200);
  EXPECT_FALSE(valueAt(v, PatientPoint(0, 0, 2.6)));
  EXPECT_FALSE(valueAt(v, PatientPoint(0, 0, 4.4)));
  EXPECT_EQ(valueAt(v, PatientPoint(0, 0, 4.5))->value, 300);
  EXPECT_FALSE(valueAt(v, PatientPoint(0, 0, 5.6)));
  EXPECT_FALSE(valueAt(v, PatientPoint(0, 0, 3), Interpolation::Nearest));
  // Slab across the gap: 200 over half a mm and 300 over a whole one.
  EXPECT_NEAR(valueAlong(v, {0, 0, 2}, {0, 0, 9}, SlabMode::Mean)->value, (200 * 0.5 + 300) / 1.5, 1e-10);
  EXPECT_FALSE(valueAlong(v, {0, 0, 2.6}, {0, 0, 4.4}, SlabMode::Max));
}

TEST(SliceReference, FacesHoldAgainstRounding) {
  const auto v = floatVolume(gridOf(2, 2, 1), [](auto, auto, auto) { return 3.0; });
  for (double e : {-7e-15, 0.0, 7e-15}) {
    EXPECT_TRUE(valueAt(v, PatientPoint(0, 0, 0.5 + e)));
    EXPECT_TRUE(valueAt(v, PatientPoint(0, 0, -0.5 + e)));
  }
}

TEST(SliceReference, SlopePerSliceIsApplied) {
  VolumeInfo info;
  info.grid = gridOf(1, 1, 2);
  info.rescale = {{2, 1}, {10, -5}};
  const auto v = floatVolume(info, [](auto, auto, auto) { return 3.0; });
  EXPECT_NEAR(valueAt(v, PatientPoint(0, 0, 0.5))->value, 0.5 * 7 + 0.5 * 25, 1e-12);
}

// ---- grey -----------------------------------------------------------------------------------------------

double greyOf(double value, VoiWindow window, bool invert = false, bool inverted = false) {
  VolumeInfo info;
  info.grid = gridOf(1, 1, 1);
  info.inverted = inverted;
  SliceScene s = sliceScene(floatVolume(info, [&](auto, auto, auto) { return value; }), Plane{}, 1, 0.5);
  s.layer().window = window;
  s.layer().invert = invert;
  const std::size_t zero = 0;
  const auto p = referencePixels(s.scene, s.view, s.sources, std::span(&zero, 1));
  EXPECT_TRUE(p.ok());
  EXPECT_TRUE((*p)[0].covered);
  EXPECT_EQ((*p)[0].rgba.x, (*p)[0].rgba.z);
  return (*p)[0].rgba.x;
}

TEST(SliceReference, WindowsAreThoseOfTheStandard) {
  const VoiWindow linear{2048, 4096, VoiFunction::Linear, ""};
  EXPECT_EQ(greyOf(0, linear), 0);
  EXPECT_EQ(greyOf(4095, linear), 1);
  EXPECT_NEAR(greyOf(2047.5, linear), 0.5, 1e-15);
  EXPECT_NEAR(greyOf(1, linear), 1.0 / 4095, 1e-15);
  const VoiWindow one{100, 1, VoiFunction::Linear, ""};
  EXPECT_EQ(greyOf(99, one), 0);
  EXPECT_EQ(greyOf(99.5, one), 0);
  EXPECT_EQ(greyOf(99.625, one), 1);
  EXPECT_EQ(greyOf(100, one), 1);
  const VoiWindow two{100, 2, VoiFunction::Linear, ""};
  EXPECT_EQ(greyOf(99, two), 0);
  EXPECT_EQ(greyOf(100, two), 1);
  EXPECT_NEAR(greyOf(99.5, two), 0.5, 1e-15);
  const VoiWindow exact{2048, 4096, VoiFunction::LinearExact, ""};
  EXPECT_EQ(greyOf(0, exact), 0);
  EXPECT_EQ(greyOf(4096, exact), 1);
  EXPECT_NEAR(greyOf(1024, exact), 0.25, 1e-15);
  const VoiWindow narrow{10, 0.5, VoiFunction::Linear, ""};  // below 1: as LINEAR_EXACT
  EXPECT_NEAR(greyOf(10.125, narrow), 0.75, 1e-15);
  const VoiWindow sigmoid{50, 100, VoiFunction::Sigmoid, ""};
  EXPECT_NEAR(greyOf(50, sigmoid), 0.5, 1e-15);
  EXPECT_NEAR(greyOf(75, sigmoid), 1 / (1 + std::exp(-1.0)), 1e-15);
}

TEST(SliceReference, InvertsOnce) {
  const VoiWindow w{0.5, 1, VoiFunction::LinearExact, ""};
  EXPECT_NEAR(greyOf(0.25, w), 0.25, 1e-15);
  EXPECT_NEAR(greyOf(0.25, w, true), 0.75, 1e-15);
  EXPECT_NEAR(greyOf(0.25, w, false, true), 0.75, 1e-15);
  EXPECT_NEAR(greyOf(0.25, w, true, true), 0.25, 1e-15);
}

// ---- scene ----------------------------------------------------------------------------------------------

TEST(ReferenceScene, BackgroundAndLayersInOrder) {
  const auto v = floatVolume(gridOf(2, 2, 1), [](auto, auto, auto) { return 0.25; });
  const auto small = floatVolume(gridOf(1, 1, 1), [](auto, auto, auto) { return 0.75; });
  SliceScene s =
      sliceScene(v, Plane{PatientPoint(0.5, 0.5, 0), PatientVec(0, 0, -1), PatientVec(0, -1, 0)}, 4, 4);
  SliceLayer second = s.layer();
  second.source = "small";
  s.scene.layers.emplace_back(second);
  s.sources.volumes["small"] = small;
  s.scene.background = Rgb{0.1, 0.2, 0.3};
  std::vector<std::size_t> pixels{0, 5, 6, 10};
  const auto p = referencePixels(s.scene, s.view, s.sources, pixels);
  ASSERT_TRUE(p.ok());
  EXPECT_EQ((*p)[0].rgba, glm::dvec4(0.1, 0.2, 0.3, 1));
  EXPECT_FALSE((*p)[0].covered);
  EXPECT_TRUE(std::isnan((*p)[0].value));
  EXPECT_NEAR((*p)[1].rgba.x, 0.75, 1e-12);  // axial: +x right, +y down; voxel (0,0) top left
  EXPECT_NEAR((*p)[2].rgba.x, 0.25, 1e-12);
  EXPECT_NEAR((*p)[3].rgba.x, 0.25, 1e-12);
}

TEST(ReferenceScene, FitsTheVolumeWithItsBorder) {
  // 10 x 4 x 1 mm seen from the feet in 20 x 20 pixels: half a mm a pixel, rows 6..13 covered.
  const auto v = floatVolume(gridOf(10, 4, 1), [](auto i, auto, auto) { return static_cast<double>(i); });
  SliceScene s = sliceScene(v, Plane{v->grid().centre(), PatientVec(0, 0, -1), PatientVec(0, -1, 0)}, 20, 1);
  s.scene.camera.height_mm.reset();
  std::vector<std::size_t> pixels{20 * 10 + 0, 20 * 10 + 19, 20 * 5 + 10,
                                  20 * 6 + 10, 20 * 13 + 10, 20 * 14 + 10};
  auto p = referencePixels(s.scene, s.view, s.sources, pixels);
  ASSERT_TRUE(p.ok());
  EXPECT_EQ((*p)[0].value, 0);
  EXPECT_EQ((*p)[1].value, 9);
  EXPECT_FALSE((*p)[2].covered);
  EXPECT_TRUE((*p)[3].covered);
  EXPECT_TRUE((*p)[4].covered);
  EXPECT_FALSE((*p)[5].covered);
  // Twice as near, and panned 2.5 mm to the right: the left edge now shows x = 4.5 + 2.5 - 2.5 + 0.125.
  s.scene.camera.zoom = 2;
  s.scene.camera.pan_mm = {2.5, 0};
  p = referencePixels(s.scene, s.view, s.sources, pixels);
  EXPECT_NEAR((*p)[0].value, 4.625, 1e-12);
}

TEST(ReferenceScene, RefusesWhatItCannotKnow) {
  const auto v = floatVolume(gridOf(2, 2, 2), [](auto, auto, auto) { return 1.0; });
  const std::vector<std::size_t> one{0};
  SliceScene s = sliceScene(v, Plane{PatientPoint(), PatientVec(0, 0, 0), PatientVec(0, 1, 0)}, 4, 4);
  EXPECT_EQ(referencePixels(s.scene, s.view, s.sources, one).error().code, ErrorCode::PlaneDegenerate);
  s.layer().plane = Plane{PatientPoint(), PatientVec(0, 0, 1), PatientVec(0, 0, 2)};
  EXPECT_EQ(referencePixels(s.scene, s.view, s.sources, one).error().code, ErrorCode::PlaneDegenerate);
  s.layer().plane = Plane{PatientPoint(), PatientVec(0, 0, kNan), PatientVec(0, 1, 0)};
  EXPECT_EQ(referencePixels(s.scene, s.view, s.sources, one).error().code, ErrorCode::PlaneDegenerate);
  s.layer().plane = Plane{};
  s.layer().source = "other";
  EXPECT_EQ(referencePixels(s.scene, s.view, s.sources, one).error().code, ErrorCode::SceneInvalid);
  s.layer().source = "v";
  EXPECT_EQ(referencePixels(s.scene, s.view, s.sources, std::vector<std::size_t>{16}).error().code,
            ErrorCode::SceneInvalid);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(referencePixels(s.scene, s.view, s.sources, one, {}, stop.get_token()).error().code,
            ErrorCode::Cancelled);
  s.scene.layers.emplace_back(CustomLayer{"shells", 1, "{}"});
  EXPECT_EQ(referencePixels(s.scene, s.view, s.sources, one).error().code, ErrorCode::NotBuiltYet);
}

}  // namespace
}  // namespace vernier::quality
