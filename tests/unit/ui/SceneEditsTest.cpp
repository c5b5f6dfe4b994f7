// SPDX-License-Identifier: GPL-3.0-or-later
#include "SceneEdits.h"

#include <gtest/gtest.h>

#include "Facts.h"
#include "Place.h"
#include "vernier/plan/Presets.h"

namespace vernier::ui {
namespace {

using test::axialGrid;

VoiWindow window(double c, double w, VoiFunction f = VoiFunction::Linear) { return {c, w, f, ""}; }

TEST(SceneEdits, OneUnitAPixelAtWidth500) {
  const VoiWindow w = draggedWindow(window(40, 500), {30, -20}, false);
  EXPECT_DOUBLE_EQ(w.width, 530);  // right: wider
  EXPECT_DOUBLE_EQ(w.center, 20);  // up: brighter, so lower values become white
}

TEST(SceneEdits, WindowingIsProportionalToTheWidth) {
  const VoiWindow w = draggedWindow(window(0, 2000), {10, 10}, false);
  EXPECT_DOUBLE_EQ(w.width, 2040);
  EXPECT_DOUBLE_EQ(w.center, 40);
}

TEST(SceneEdits, UpIsBrighterOfInvertedPicturesToo) {
  EXPECT_DOUBLE_EQ(draggedWindow(window(40, 500), {0, -20}, true).center, 60);
}

TEST(SceneEdits, AHandMovesTheSameAtEveryScale) {
  EXPECT_DOUBLE_EQ(draggedWindow(window(0, 500), {60, 0}, false, 2).width, 530);
}

TEST(SceneEdits, WidthStaysUsable) {
  EXPECT_DOUBLE_EQ(draggedWindow(window(0, 500), {-10000, 0}, false).width, 1);
  EXPECT_GT(draggedWindow(window(0, 0.5, VoiFunction::LinearExact), {-10000, 0}, false).width, 0);
  EXPECT_DOUBLE_EQ(draggedWindow(window(0, 0.5), {-10000, 0}, false).width, 0.5);
}

TEST(SceneEdits, ImagesScrollByOneAndStopAtTheEnds) {
  Scene s = stackScene("a", 3, {});
  EXPECT_EQ(imageOf(scrolledImage(s, 1, 10))->index, 4);
  EXPECT_EQ(imageOf(scrolledImage(s, -100, 10))->index, 0);
  EXPECT_EQ(imageOf(scrolledImage(s, 100, 10))->index, 9);
}

class Slices : public testing::TestWithParam<const char*> {};

TEST_P(Slices, EachNotchIsOneVoxelSliceInOrder) {
  const GridGeometry g = axialGrid();
  const Scene first = *presetScene(GetParam(), "a", g, {});
  const PatientVec n = sliceOf(first)->plane.normal;
  const std::int64_t count = sliceAxis(g, n).count, middle = count / 2;
  ASSERT_EQ(sliceNumber(*sliceOf(first), g), middle);
  Scene s = first;
  for (std::int64_t k = middle + 1; k < count + 3; ++k) {
    s = scrolledSlice(s, 1, g);
    EXPECT_EQ(sliceNumber(*sliceOf(s), g), std::min(k, count - 1));
  }
  s = scrolledSlice(first, -3, g);
  EXPECT_EQ(sliceNumber(*sliceOf(s), g), middle - 3);
  // The picture does not shift: the plane moved along its normal only.
  EXPECT_NEAR(length(cross(sliceOf(s)->plane.point - sliceOf(first)->plane.point, n)), 0, 1e-9);
}
INSTANTIATE_TEST_SUITE_P(Views, Slices, testing::Values("axial", "coronal", "sagittal"));

TEST(SceneEdits, FromBetweenTwoSlicesTheFirstNotchGoesToTheNextOne) {
  const GridGeometry g = axialGrid();
  Scene s = *presetScene("axial", "a", g, {});
  auto& plane = std::get<SliceLayer>(s.layers[0]).plane;
  plane.point.p.z = 10 + 2 * 7.25;
  EXPECT_EQ(sliceNumber(*sliceOf(s), g), std::nullopt);
  EXPECT_EQ(sliceNumber(*sliceOf(scrolledSlice(s, 1, g)), g), 8);
  EXPECT_EQ(sliceNumber(*sliceOf(scrolledSlice(s, -1, g)), g), 7);
}

TEST(SceneEdits, UnevenStacksScrollThroughTheirTruePlaces) {
  GridGeometry g = axialGrid(5);
  for (double z : {0.0, 1.0, 2.5, 3.0, 4.0}) g.sliceOrigin_vox.emplace_back(0, 0, z);
  Scene s = *presetScene("axial", "a", g, {});
  EXPECT_DOUBLE_EQ(sliceOf(s)->plane.point.p.z, 10 + 2 * 2.5);
  EXPECT_DOUBLE_EQ(sliceOf(scrolledSlice(s, 1, g))->plane.point.p.z, 10 + 2 * 3.0);
  EXPECT_DOUBLE_EQ(sliceOf(scrolledSlice(s, -1, g))->plane.point.p.z, 10 + 2 * 1.0);
}

// What lay under the hand lies under it again after the drag.
TEST(SceneEdits, PanKeepsTheTissueUnderTheHand) {
  const GridGeometry g = axialGrid();
  const View view{400, 300, false};
  const SourceFacts facts = test::axialFacts(0, "a");
  for (const Scene& before : {*presetScene("coronal", "a", g, {}), stackScene("a", 4, {})}) {
    const Place a = *placeOf(before, facts, &g, view);
    const Place b = *placeOf(panned(before, {37, -21}, a.unit_mm), facts, &g, view);
    EXPECT_NEAR(length(a.patientAt({100, 80}) - b.patientAt({137, 59})), 0, 1e-9);
  }
}

TEST(SceneEdits, ZoomKeepsThePointUnderTheHand) {
  const GridGeometry g = axialGrid();
  const View view{400, 300, false};
  const SourceFacts facts = test::axialFacts(0, "a");
  for (const Scene& before : {*presetScene("sagittal", "a", g, {}), stackScene("a", 4, {})}) {
    const Place a = *placeOf(before, facts, &g, view);
    const glm::dvec2 hand(310, 40);
    const Scene after = zoomed(before, {0, -60}, hand - glm::dvec2(200, 150), a.unit_mm);
    EXPECT_GT(after.camera.zoom, before.camera.zoom);
    const Place b = *placeOf(after, facts, &g, view);
    EXPECT_NEAR(length(a.patientAt(hand) - b.patientAt(hand)), 0, 1e-9);
  }
}

}  // namespace
}  // namespace vernier::ui
