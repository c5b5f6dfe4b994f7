// SPDX-License-Identifier: GPL-3.0-or-later
#include "Workspace.h"

#include <gtest/gtest.h>

#include "Facts.h"
#include "vernier/plan/Presets.h"

namespace vernier::ui {
namespace {

using test::axialFacts;

Workspace withStack() {
  Workspace w;
  w.know(axialFacts(0, "a"));
  w.open({0, "a"}, 0);
  return w;
}

double offPlane(const Workspace& w, int t, PatientPoint p) {
  const Plane& plane = sliceOf(w.tile(t).scene)->plane;
  return std::abs(dot(p - plane.point, normalize(plane.normal)));
}

TEST(Workspace, ASeriesOpensAsStackAtItsMiddleSlice) {
  const Workspace w = withStack();
  EXPECT_EQ(w.tile(0).view, "stack");
  ASSERT_NE(imageOf(w.tile(0).scene), nullptr);
  EXPECT_EQ(imageOf(w.tile(0).scene)->index, 10);
}

TEST(Workspace, MprIsOnlyForStacksThatPassedAndSaysWhyNot) {
  Workspace w;
  SourceFacts f = axialFacts(0, "a");
  f.grid.reset();
  f.why2d = "The slices are not parallel.";
  w.know(f);
  w.open({0, "a"}, 0);
  const Arrangement before = w.now();
  const Result<void> r = w.openMpr();
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().sentence, "The slices are not parallel.");
  EXPECT_EQ(w.now(), before);
}

TEST(Workspace, MprShowsFourPlanesThroughOnePoint) {
  Workspace w = withStack();
  w.setWindow(0, {40, 80, VoiFunction::Linear, ""});
  ASSERT_TRUE(w.openMpr());
  EXPECT_EQ(w.shown(), (std::vector<int>{0, 1, 2, 3}));
  const char* views[] = {"axial", "coronal", "sagittal", "oblique"};
  const auto cross = w.crosshair(0);
  ASSERT_TRUE(cross);
  for (int t = 0; t < 4; ++t) {
    EXPECT_EQ(w.tile(t).view, views[t]);
    EXPECT_NEAR(offPlane(w, t, *cross), 0, 1e-9);
    EXPECT_EQ(sliceOf(w.tile(t).scene)->window->width, 80);
  }
}

TEST(Workspace, MprBeginsInTheImageThatWasShownAndStackGoesBackToIt) {
  Workspace w = withStack();
  w.scroll(0, -7);
  ASSERT_TRUE(w.openMpr());
  EXPECT_NEAR(w.crosshair(0)->p.z, 10 + 2 * 3, 1e-9);
  w.scroll(0, 2);
  w.openStack();
  EXPECT_EQ(w.now().layout, Layout::Single);
  EXPECT_EQ(imageOf(w.tile(0).scene)->index, 5);
}

TEST(Workspace, TheNextTimePointKeepsAllElse) {
  Workspace w = withStack();
  w.know(axialFacts(0, "b"));
  w.scroll(0, 3);
  w.setWindow(0, {40, 80, VoiFunction::Linear, ""});
  Scene expected = w.tile(0).scene;
  std::get<ImageLayer>(expected.layers[0]).source = "b";
  w.replaceSource(0, {0, "b"});
  EXPECT_EQ(w.tile(0).scene, expected);
}

TEST(Workspace, MovingTheCrosshairMovesEveryLinkedPlane) {
  Workspace w = withStack();
  ASSERT_TRUE(w.openMpr());
  const PatientPoint p(-3.25, 4.5, 31);
  w.moveCrosshair(0, p);
  for (int t = 0; t < 4; ++t) EXPECT_NEAR(offPlane(w, t, p), 0, 1e-9);
}

TEST(Workspace, ScrollingOnePlaneCarriesTheCrosshair) {
  Workspace w = withStack();
  ASSERT_TRUE(w.openMpr());
  const PatientPoint before = *w.crosshair(0);
  w.scroll(0, 1);
  const PatientPoint after = *w.crosshair(0);
  EXPECT_NEAR(length(after - before), 2, 1e-9);
  EXPECT_NEAR(after.p.z - before.p.z, 2, 1e-9);
  for (int t = 0; t < 4; ++t) EXPECT_NEAR(offPlane(w, t, after), 0, 1e-9);
}

TEST(Workspace, OtherFramesOfReferenceAndPatientsStayWhereTheyAre) {
  for (const auto& [frame, person] : {std::pair("9.9", "A"), std::pair("1.2.3", "B")}) {
    Workspace w = withStack();
    w.know(axialFacts(1, "b", frame, person));
    ASSERT_TRUE(w.openMpr());
    w.open({1, "b"}, 1);
    const Scene before = w.tile(1).scene;
    w.moveCrosshair(0, PatientPoint(1, 2, 15));
    EXPECT_EQ(w.tile(1).scene, before);
    EXPECT_FALSE(w.linked(0, 1));
  }
}

TEST(Workspace, AStackOfTheSameFrameGoesToTheNearestImage) {
  Workspace w = withStack();
  w.know(axialFacts(0, "b"));
  ASSERT_TRUE(w.openMpr());
  w.open({0, "b"}, 3);
  w.moveCrosshair(0, PatientPoint(0, 0, 10 + 2 * 6.3));
  EXPECT_EQ(imageOf(w.tile(3).scene)->index, 6);
}

std::int64_t imageAt(const Workspace& w, int t) { return imageOf(w.tile(t).scene)->index; }

Workspace pair(const std::string& linkOfSecond) {
  Workspace w = withStack();
  SourceFacts f = axialFacts(0, "b");
  if (!linkOfSecond.empty()) f.linkKey = linkOfSecond;
  w.know(f);
  w.setLayout(Layout::Pair);
  w.open({0, "b"}, 1);
  return w;
}

TEST(Workspace, TogetherImagesFollowByTheirPlaceInOneFrameOfReference) {
  Workspace w = pair("");
  ASSERT_TRUE(w.linked(0, 1));
  w.scroll(1, 3);
  EXPECT_EQ(imageAt(w, 0), 10);  // each by itself at first
  w.setTogether(true);
  EXPECT_FALSE(w.togetherIsManual());
  w.scroll(0, -2);
  EXPECT_EQ(imageAt(w, 0), 8);
  EXPECT_EQ(imageAt(w, 1), 8);  // by place, whatever the offset was
  w.undo();
  EXPECT_EQ(imageAt(w, 0), 10);
  EXPECT_EQ(imageAt(w, 1), 13);
}

TEST(Workspace, TogetherWithoutACommonFrameTheOffsetIsKeptAndItIsCalledManual) {
  Workspace w = pair("elsewhere");
  ASSERT_FALSE(w.linked(0, 1));
  w.scroll(1, 3);
  w.setTogether(true);
  EXPECT_TRUE(w.togetherIsManual());
  w.scroll(0, -2);
  EXPECT_EQ(imageAt(w, 0), 8);
  EXPECT_EQ(imageAt(w, 1), 11);
  w.scroll(0, 1000);  // to the end and back: nothing is lost at the other's end
  const std::int64_t last = imageAt(w, 0);
  w.scroll(0, 8 - static_cast<int>(last));
  EXPECT_EQ(imageAt(w, 0), 8);
  EXPECT_EQ(imageAt(w, 1), 11);
  w.setTogether(false);
  w.scroll(0, 1);
  EXPECT_EQ(imageAt(w, 1), 11);
}

TEST(Workspace, TogetherPanAndZoomAreShared) {
  Workspace w = pair("elsewhere");
  w.setTogether(true);
  Scene zoomedIn = w.tile(0).scene;
  zoomedIn.camera.zoom = 2.5;
  w.setScene(0, Gesture::Zoom, zoomedIn);
  EXPECT_EQ(w.tile(1).scene.camera.zoom, 2.5);
  EXPECT_EQ(imageAt(w, 1), 10);
}

TEST(Workspace, TwoPeopleSideBySideAreTold) {
  Workspace w = withStack();
  w.know(axialFacts(1, "b", "1.2.3", "B"));
  w.setLayout(Layout::Pair);
  EXPECT_FALSE(w.differentPeople());
  w.open({1, "b"}, 1);
  EXPECT_TRUE(w.differentPeople());
  w.toggleMaximised(1);
  EXPECT_FALSE(w.differentPeople());  // only one of them is in sight
}

TEST(Workspace, EveryEditIsUndoneAndRedone) {
  Workspace w = withStack();
  std::vector<Arrangement> seen{w.now()};
  const auto step = [&] { seen.push_back(w.now()); };
  w.setWindow(0, {40, 80, VoiFunction::Linear, ""}), step();
  w.scroll(0, 2), step();
  w.invert(0), step();
  ASSERT_TRUE(w.openMpr());
  step();
  w.moveCrosshair(0, PatientPoint(1, 2, 20)), step();
  w.toggleMaximised(2), step();
  w.setScene(2, Gesture::Pan, panned(w.tile(2).scene, {10, 0}, 0.5)), step();
  w.resetView(2), step();
  for (std::size_t k = seen.size(); k-- > 1;) {
    EXPECT_EQ(w.now(), seen[k]);
    w.undo();
  }
  EXPECT_EQ(w.now(), seen[0]);
  for (std::size_t k = 1; k < seen.size(); ++k) {
    w.redo();
    EXPECT_EQ(w.now(), seen[k]);
  }
  EXPECT_FALSE(w.canRedo());
}

TEST(Workspace, UndoNeverTakesAwayTheFirstSeries) {
  Workspace w;
  w.know(axialFacts(0, "a"));
  w.know(axialFacts(0, "b"));
  w.setLayout(Layout::Pair);  // a step on an empty desk, which is gone with it
  w.open({0, "a"}, 0);
  const Arrangement opened = w.now();
  EXPECT_FALSE(w.canUndo());
  w.scroll(0, 1);
  w.undo();
  w.undo();
  EXPECT_EQ(w.now(), opened);
  w.open({0, "b"}, 0);  // in place of the first: this can be undone
  w.undo();
  EXPECT_EQ(w.now(), opened);
}

TEST(Workspace, AnInversionOutlivesWindowSliceAndView) {
  Workspace w = withStack();
  w.invert(0);
  w.setWindow(0, {40, 80, VoiFunction::Linear, ""});
  w.scroll(0, 3);
  w.choose(0, {});
  EXPECT_TRUE(imageOf(w.tile(0).scene)->invert);
  ASSERT_TRUE(w.openMpr());
  w.scroll(1, 2);
  w.setWindow(2, {40, 80, VoiFunction::Linear, ""});
  for (int t = 0; t < 4; ++t) EXPECT_TRUE(sliceOf(w.tile(t).scene)->invert) << t;
  w.openStack();
  EXPECT_TRUE(imageOf(w.tile(0).scene)->invert);
  w.invert(0);
  ASSERT_TRUE(w.openMpr());
  for (int t = 0; t < 4; ++t) EXPECT_FALSE(sliceOf(w.tile(t).scene)->invert) << t;
}

TEST(Workspace, ADragIsOneStepAndNotchesInARowAreOne) {
  Workspace w = withStack();
  const Arrangement before = w.now();
  w.beginDrag();
  for (int k = 1; k <= 20; ++k) w.setWindow(0, {40.0 + k, 400, VoiFunction::Linear, ""});
  w.endDrag();
  for (int k = 0; k < 5; ++k) w.scroll(0, 1);
  w.undo();
  EXPECT_EQ(imageOf(w.tile(0).scene)->index, 10);
  EXPECT_EQ(imageOf(w.tile(0).scene)->window->center, 60);
  w.undo();
  EXPECT_EQ(w.now(), before);
}

TEST(Workspace, TwoDragsAreTwoStepsAndAnIdleOneIsNone) {
  Workspace w = withStack();
  const Arrangement start = w.now();
  for (double width : {100.0, 200.0}) {
    w.beginDrag();
    w.setWindow(0, {40, width, VoiFunction::Linear, ""});
    w.endDrag();
  }
  w.beginDrag();
  w.endDrag();
  w.undo();
  EXPECT_EQ(imageOf(w.tile(0).scene)->window->width, 100);
  w.undo();
  EXPECT_EQ(w.now(), start);
}

TEST(Workspace, ForgettingADocumentEmptiesItsTilesOnly) {
  Workspace w = withStack();
  w.know(axialFacts(1, "b"));
  w.setLayout(Layout::Pair);
  w.open({1, "b"}, 1);
  w.forget(0);
  EXPECT_TRUE(w.tile(0).empty());
  EXPECT_FALSE(w.tile(1).empty());
  EXPECT_FALSE(w.canUndo());
}

TEST(WindowChoices, CtPresetsOnlyForHu) {
  WindowFacts f;
  f.unit = "HU";
  f.automatic = {0, 100, VoiFunction::LinearExact, ""};
  EXPECT_EQ(windowChoices(f).front().name, "Brain");
  f.unit = "stored value";
  f.windows = {{600, 1200, VoiFunction::Linear, "WINDOW1"}};
  f.range = {0, 4000};
  const auto choices = windowChoices(f);
  ASSERT_EQ(choices.size(), 3u);
  EXPECT_EQ(choices[0].name, "WINDOW1");
  EXPECT_EQ(choices[1].name, "Automatic");
  EXPECT_EQ(choices[2].name, "Full range");
  EXPECT_EQ(choices[2].window->center, 2000);
  EXPECT_EQ(choices[2].window->width, 4000);
}

}  // namespace
}  // namespace vernier::ui
