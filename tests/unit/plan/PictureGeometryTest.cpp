// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/PictureGeometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "Grids.h"

namespace vernier {
namespace {

GridGeometry cube() {
  GridGeometry g;
  g.columns = g.rows = g.slices = 10;
  return g;
}
SliceLayer axialAt(PatientPoint p) {
  SliceLayer layer;
  layer.plane.point = p;
  return layer;
}
void expectNear(glm::dvec3 a, glm::dvec3 b, double tolerance = 1e-12) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance) << "component " << k;
}

TEST(SlicePicture, FittedShowsTheBoxWithItsHalfVoxelBorder) {
  const auto p = slicePicture(axialAt(cube().centre()), {}, {20, 20, false}, cube());
  ASSERT_TRUE(p.ok());
  EXPECT_DOUBLE_EQ(p->mmPerPixel, 0.5);
  expectNear(p->origin.p, {-0.5, -0.5, 4.5});
  expectNear(p->right.v, {0.5, 0, 0});
  expectNear(p->down.v, {0, 0.5, 0});
  expectNear(p->normal.v, {0, 0, -1});
}

TEST(SlicePicture, WideAndHighPicturesFitTheLargerSide) {
  for (const View view : {View{40, 20, false}, View{20, 40, false}}) {
    const auto p = slicePicture(axialAt(cube().centre()), {}, view, cube());
    ASSERT_TRUE(p.ok());
    EXPECT_DOUBLE_EQ(p->mmPerPixel, 0.5);
    const glm::dvec3 centre =
        p->origin.p + p->right.v * (view.width_px / 2.0) + p->down.v * (view.height_px / 2.0);
    expectNear(centre, cube().centre().p);
  }
}

TEST(SlicePicture, ScrollingAlongTheNormalKeepsTheScale) {
  GridGeometry g = cube();
  g.patientFromVoxel.linear = glm::dmat3({1, 0, 0}, {0, 0.8, 0.6}, {0, -1.2, 1.6});
  const auto at = [&](double d) {
    SliceLayer layer = axialAt(g.centre() + PatientVec(0, 0, d));
    return slicePicture(layer, {}, {64, 64, false}, g)->mmPerPixel;
  };
  EXPECT_DOUBLE_EQ(at(0), at(7.5));
}

TEST(SlicePicture, UnevenSlicesAreFittedWhereTheyAre) {
  GridGeometry g = cube();
  for (int s = 0; s < 10; ++s) g.sliceOrigin_vox.push_back({s == 4 ? 6.0 : 0.0, 0, s});
  const auto p = slicePicture(axialAt({4.5, 4.5, 4.5}), {}, {22, 22, false}, g);
  EXPECT_DOUBLE_EQ(p->mmPerPixel, 2 * (9.5 + 6 - 4.5) / 22);
}

TEST(SlicePicture, HeightZoomAndPan) {
  Camera camera;
  camera.height_mm = 100;
  camera.zoom = 2;
  camera.pan_mm = {3, 4};  // right = patient left, up = anterior
  const auto p = slicePicture(axialAt({10, 20, 30}), camera, {300, 200, false}, cube());
  ASSERT_TRUE(p.ok());
  EXPECT_DOUBLE_EQ(p->mmPerPixel, 0.25);
  expectNear(p->origin.p, {10 + 3 - 37.5, 20 - 4 - 25, 30});
}

TEST(SlicePicture, UpIsProjectedAndLengthsDoNotMatter) {
  SliceLayer layer = axialAt(cube().centre());
  layer.plane.normal = PatientVec(0, 0, -1e-200);
  layer.plane.up = PatientVec(0, -3e200, 5e200);
  const auto p = slicePicture(layer, {}, {20, 20, false}, cube());
  ASSERT_TRUE(p.ok());
  expectNear(p->right.v, {0.5, 0, 0});
  expectNear(p->down.v, {0, 0.5, 0});
}

TEST(SlicePicture, DegeneratePlanesAreRefused) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const auto code = [](const SliceLayer& l, const Camera& c = {}) {
    const auto p = slicePicture(l, c, {20, 20, false}, cube());
    return p.ok() ? std::string("ok") : std::string(errorName(p.error().code));
  };
  SliceLayer l = axialAt({});
  l.plane.normal = PatientVec(0, 0, 0);
  EXPECT_EQ(code(l), "PlaneDegenerate");
  l = axialAt({});
  l.plane.up = PatientVec(0, 0, 0);
  EXPECT_EQ(code(l), "PlaneDegenerate");
  l = axialAt({});
  l.plane.up = PatientVec(0, 0, 5);
  EXPECT_EQ(code(l), "PlaneDegenerate");
  l.plane.up = PatientVec(0, 0.9e-6, -1);
  EXPECT_EQ(code(l), "PlaneDegenerate");
  l.plane.up = PatientVec(0, 1.1e-6, -1);
  EXPECT_EQ(code(l), "ok");
  for (double bad : {nan, inf}) {
    l = axialAt({bad, 0, 0});
    EXPECT_EQ(code(l), "PlaneDegenerate");
    l = axialAt({});
    l.plane.normal = PatientVec(bad, 0, 0);
    EXPECT_EQ(code(l), "PlaneDegenerate");
    Camera c;
    c.pan_mm.x = bad;
    EXPECT_EQ(code(axialAt({}), c), "PlaneDegenerate");
  }
  Camera c;
  c.zoom = 0;
  EXPECT_EQ(code(axialAt({}), c), "SceneInvalid");
  c.zoom = 1;
  c.height_mm = -1;
  EXPECT_EQ(code(axialAt({}), c), "SceneInvalid");
  EXPECT_FALSE(slicePicture(axialAt({}), {}, {0, 20, false}, cube()).ok());
}

TEST(SlicePicture, FullTurnReturnsToTheStart) {  // NUMERICS C5
  SliceLayer layer = axialAt(cube().centre());
  glm::dvec3 normal{0, 0, -1}, up{0, -1, 0};
  const double s = std::sin(2 * std::numbers::pi / 3600), c = std::cos(2 * std::numbers::pi / 3600);
  const auto turn = [&](glm::dvec3 v) { return glm::dvec3(v.x, c * v.y - s * v.z, s * v.y + c * v.z); };
  for (int k = 0; k < 3600; ++k) {
    normal = turn(normal), up = turn(up);
    layer.plane.normal = PatientVec(normal);
    layer.plane.up = PatientVec(up);
    const auto p = slicePicture(layer, {}, {20, 20, false}, cube());
    ASSERT_TRUE(p.ok());
    ASSERT_NEAR(glm::dot(p->right.v, p->down.v), 0, 1e-12);
    ASSERT_NEAR(glm::length(p->down.v), p->mmPerPixel, 1e-12);
  }
  expectNear(normal, {0, 0, -1}, 1e-9);
  expectNear(slicePicture(layer, {}, {20, 20, false}, cube())->right.v, {0.5, 0, 0}, 1e-9);
}

ImageFrameInfo frame(std::int64_t columns, std::int64_t rows, glm::dvec2 spacing) {
  ImageFrameInfo info;
  info.columns = columns;
  info.rows = rows;
  info.pixelSpacing_mm = spacing;
  return info;
}
// Where the middle of a frame's pixel is in the picture.
glm::dvec2 placeOf(const ImagePicture& p, double column, double row) {
  return {p.x0 + (column + 0.5) * p.pxPerColumn, p.y0 + (row + 0.5) * p.pxPerRow};
}

TEST(ImagePicture, KeepsThePixelAspectRowFirst) {
  // Rows 2 mm apart, columns 1 mm: a 20 x 10 frame is a square of 20 mm.
  const ImagePicture p = imagePicture({}, {}, {100, 100, false}, frame(20, 10, {2, 1}));
  EXPECT_DOUBLE_EQ(p.pxPerColumn, 5);
  EXPECT_DOUBLE_EQ(p.pxPerRow, 10);
  EXPECT_DOUBLE_EQ(p.mmPerPixel, 0.2);
  EXPECT_DOUBLE_EQ(p.x0, 0);
  EXPECT_DOUBLE_EQ(p.y0, 0);
}

TEST(ImagePicture, UnknownSpacingIsSquareAndHasNoMillimetres) {
  for (const glm::dvec2 bad : {glm::dvec2{0, 0}, glm::dvec2{1, 0}, glm::dvec2{1e-9, 1}, glm::dvec2{1, 1e6},
                               glm::dvec2{std::nan(""), 1}}) {
    const ImagePicture p = imagePicture({}, {}, {100, 200, false}, frame(50, 50, bad));
    EXPECT_DOUBLE_EQ(p.pxPerColumn, 2);
    EXPECT_DOUBLE_EQ(p.pxPerRow, 2);
    EXPECT_EQ(p.mmPerPixel, 0);
    EXPECT_DOUBLE_EQ(p.y0, 50);
  }
}

TEST(ImagePicture, FlipsMirrorAboutTheMiddle) {
  const ImageFrameInfo f = frame(4, 2, {1, 1});
  ImageLayer layer;
  layer.flipHorizontal = true;
  const ImagePicture p = imagePicture(layer, {}, {4, 4, false}, f);
  EXPECT_EQ(placeOf(p, 0, 0), glm::dvec2(3.5, 1.5));
  EXPECT_EQ(placeOf(p, 3, 1), glm::dvec2(0.5, 2.5));
  layer = {};
  layer.flipVertical = true;
  EXPECT_EQ(placeOf(imagePicture(layer, {}, {4, 4, false}, f), 0, 0), glm::dvec2(0.5, 2.5));
}

TEST(ImagePicture, ZoomPanAndHeight) {
  Camera camera;
  camera.zoom = 2;
  camera.pan_mm = {1, 3};
  const ImagePicture p = imagePicture({}, camera, {10, 10, false}, frame(10, 10, {1, 1}));
  EXPECT_DOUBLE_EQ(p.pxPerColumn, 2);
  EXPECT_EQ(placeOf(p, 5.5, 1.5), glm::dvec2(5, 5)) << "the picture's centre moved 1 mm right and 3 mm up";
  camera = {};
  camera.height_mm = 40;
  EXPECT_DOUBLE_EQ(imagePicture({}, camera, {10, 10, false}, frame(10, 10, {1, 1})).mmPerPixel, 4);
}

TEST(Letters, LargestFirstUpToThree) {
  EXPECT_EQ(lettersOf(PatientVec(1, 0, 0)), "L");
  EXPECT_EQ(lettersOf(PatientVec(-2, 0, 0)), "R");
  EXPECT_EQ(lettersOf(PatientVec(0, 1, 0)), "P");
  EXPECT_EQ(lettersOf(PatientVec(0, -1, 0)), "A");
  EXPECT_EQ(lettersOf(PatientVec(0, 0, 1)), "H");
  EXPECT_EQ(lettersOf(PatientVec(0, 0, -1)), "F");
  EXPECT_EQ(lettersOf(PatientVec(0.3, -0.9, 0.2)), "ALH");
  EXPECT_EQ(lettersOf(PatientVec(0.0999, 0.995, 0)), "P");
  EXPECT_EQ(lettersOf(PatientVec(0.1001, 0.995, 0)), "PL");
  EXPECT_EQ(lettersOf(PatientVec(1, 1 + 1e-12, -1)), "LPF") << "equal but for rounding: x, y, z";
  EXPECT_EQ(lettersOf(PatientVec(0, 0, 0)), "");
  EXPECT_EQ(lettersOf(PatientVec(std::nan(""), 0, 0)), "");
}

TEST(Letters, OfAFrameFollowWhatIsDisplayed) {
  ImageFrameInfo f = frame(4, 4, {1, 1});
  f.plane = FramePlane{{}, PatientVec(1, 0, 0), PatientVec(0, 1, 0)};
  f.patientOrientation = "A\\F";  // the plane wins
  EXPECT_EQ(edgeLetters(ImageLayer{}, f), (EdgeLetters{"R", "L", "A", "P"}));
  ImageLayer flipped;
  flipped.flipHorizontal = true;
  EXPECT_EQ(edgeLetters(flipped, f), (EdgeLetters{"L", "R", "A", "P"}));
  flipped.flipVertical = true;
  EXPECT_EQ(edgeLetters(flipped, f), (EdgeLetters{"L", "R", "P", "A"}));
}

TEST(Letters, OfPatientOrientationNeverGuessed) {
  ImageFrameInfo f = frame(4, 4, {0, 0});
  f.patientOrientation = "A\\FL ";
  EXPECT_EQ(edgeLetters(ImageLayer{}, f), (EdgeLetters{"P", "A", "HR", "FL"}));
  for (const char* none : {"", "\\", "L", "L\\", "LE\\V", "CR\\D", "L\\P\\H", "l\\p"}) {
    f.patientOrientation = none;
    EXPECT_EQ(edgeLetters(ImageLayer{}, f), EdgeLetters{}) << none;
  }
}

}  // namespace
}  // namespace vernier
