// SPDX-License-Identifier: GPL-3.0-or-later
#include "Looks.h"

#include <gtest/gtest.h>

#include "Enlarge.h"
#include "Facts.h"
#include "SceneEdits.h"
#include "Workspace.h"
#include "vernier/picture/Describe.h"
#include "vernier/plan/CameraPicture.h"

namespace vernier::ui {
namespace {

constexpr View kView{400, 300, false};

SourceFacts ct() {
  SourceFacts f = test::axialFacts(0, "a");
  f.modality = "CT";
  return f;
}
Scene scene(const std::string& look) {
  for (const VolumeLook& l : volumeLooks(ct()))
    if (l.name == look) return *sceneOfLook(l, ct());
  ADD_FAILURE() << look;
  return {};
}
CameraPicture camera(const Scene& s) { return *cameraPicture(s.camera, kView, cameraBox(*ct().grid)); }
glm::dvec2 seen(const Scene& s, PatientPoint p) {
  const glm::dvec4 at = camera(s).pixelFromPatient() * glm::dvec4(p.p, 1);
  return glm::dvec2(at) / at.w;
}
// The box's middle.
PatientPoint centre() { return cameraBox(*ct().grid).centre; }

TEST(Looks, EachIsAPictureThroughTheVolumeThatNamesItself) {
  for (const char* modality : {"CT", "MR", "PT", ""}) {
    SourceFacts f = ct();
    f.modality = modality;
    const std::vector<VolumeLook> looks = volumeLooks(f);
    EXPECT_GE(looks.size(), 6u);
    for (const VolumeLook& look : looks) {
      const auto s = sceneOfLook(look, f);
      ASSERT_TRUE(s) << look.name;
      EXPECT_NE(lookOf(*s), nullptr) << look.name;
      EXPECT_EQ(nameOfLook(*s, look.view, f), look.name);
    }
  }
  SourceFacts colours = ct();
  colours.colour = true;
  EXPECT_EQ(volumeLooks(colours).size(), 1u) << "colours have no maximum and no level";
  EXPECT_EQ(firstLook(ct()).name, "Bone");
}

// What stands on the picture of a rendering whose transfer function was dragged.
TEST(Looks, AChangedTransferFunctionIsSaidOnThePicture) {
  VolumeInfo info;
  VolumeLayer layer;
  layer.preset = "ct-bone";
  const auto said = [&] {
    return describeRendering(layer, camera(scene("Bone")), info, false).status[0].text;
  };
  EXPECT_EQ(said(), "transfer ct-bone");
  layer.transfer = TransferFunction{{{0, glm::dvec3(1)}}, {{0, 0.5}}, 1};
  EXPECT_EQ(said(), "transfer ct-bone, changed");
}

// What is long is not cut off, from no side.
TEST(Looks, TheWholeBoxIsInSightFromFrontAndSide) {
  for (const glm::ivec3 size : {glm::ivec3(64, 48, 20), {20, 20, 180}, {300, 10, 10}, {50, 50, 50}}) {
    SourceFacts f = ct();
    f.grid->columns = size.x, f.grid->rows = size.y, f.grid->slices = size.z;
    for (const std::size_t n : {0u, 2u}) {
      const Scene s = seenFrom(*sceneOfLook(firstLook(f), f), directions()[n]);
      const CameraPicture c = *cameraPicture(s.camera, {300, 300, false}, cameraBox(*f.grid));
      for (int corner = 0; corner < 8; ++corner) {
        const VoxelPoint v(corner & 1 ? size.x - 1 : 0, corner & 2 ? size.y - 1 : 0,
                           corner & 4 ? size.z - 1 : 0);
        const glm::dvec4 at = c.pixelFromPatient() * glm::dvec4((f.grid->patientFromVoxel * v).p, 1);
        EXPECT_TRUE(at.x >= 0 && at.x <= 300 && at.y >= 0 && at.y <= 300)
            << size.z << " " << at.x << "," << at.y;
      }
    }
  }
}

// The front of what is seen follows the hand: half a degree a pixel.
TEST(Turned, TheFrontFollowsTheHand) {
  for (const double roll : {0.0, 30.0, 90.0, -120.0}) {
    Scene from = scene("MIP");
    from.camera.azimuth_deg = 25, from.camera.elevation_deg = 10, from.camera.roll_deg = roll;
    // A point before the middle, towards the eye.
    const PatientPoint front = centre() - 10.0 * camera(from).forward;
    for (const glm::dvec2 hand : {glm::dvec2(2, 0), glm::dvec2(0, 2), glm::dvec2(-2, 1)}) {
      const glm::dvec2 way = seen(turned(from, hand), front) - seen(from, front);
      EXPECT_GT(glm::dot(glm::normalize(way), glm::normalize(hand)), 0.99)
          << roll << " " << hand.x << " " << hand.y;
    }
  }
  const Scene s = turned(scene("MIP"), {20, 0});
  EXPECT_DOUBLE_EQ(s.camera.azimuth_deg, -10);
  EXPECT_DOUBLE_EQ(turned(scene("MIP"), {40, 0}, 2).camera.azimuth_deg, -10) << "at 200 %";
}

TEST(Turned, ThePatientStaysUprightAndGoingBackUndoesIt) {
  const Scene from = scene("Bone");
  EXPECT_DOUBLE_EQ(turned(from, {0, 10'000}).camera.elevation_deg, 90);
  EXPECT_DOUBLE_EQ(turned(from, {0, -10'000}).camera.elevation_deg, -90);
  const Scene far = turned(from, {5'000, 0});
  EXPECT_LE(std::abs(far.camera.azimuth_deg), 180) << "numbers stay small";
  EXPECT_EQ(turned(turned(from, {33, 21}), {-33, -21}), from);
}

TEST(Directions, EachIsSeenFromWhereItSays) {
  const glm::dvec3 towards[] = {{0, -1, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
  for (std::size_t n = 0; n < directions().size(); ++n) {
    const Scene s = seenFrom(scene("MIP"), directions()[n]);
    EXPECT_NEAR(glm::dot(-camera(s).forward.v, towards[n]), 1, 1e-12) << directions()[n].name;
  }
  // From the feet it is as axial slices are: the patient's left on the right, front on top.
  const CameraPicture feet = camera(seenFrom(scene("MIP"), directions()[5]));
  EXPECT_NEAR(feet.right.v.x, 1, 1e-12);
  EXPECT_NEAR(feet.up.v.y, -1, 1e-12);
}

TEST(DraggedTransfer, GoesLikeAWindow) {
  TransferFunction f;
  f.colours = {{0, glm::dvec3(1, 0, 0)}, {500, glm::dvec3(1)}};
  f.opacities = {{100, 0}, {100, 0.2}, {400, 1}};
  const TransferFunction wide = draggedTransfer(f, {50, 0});
  EXPECT_DOUBLE_EQ(wide.colours[0].value, -25);
  EXPECT_DOUBLE_EQ(wide.colours[1].value, 525);
  EXPECT_DOUBLE_EQ(wide.opacities[2].value, 415);
  EXPECT_EQ(wide.opacities[0].value, wide.opacities[1].value) << "a step stays one";
  EXPECT_EQ(wide.opacities[2].opacity, 1);
  const TransferFunction up = draggedTransfer(f, {0, -30});  // brighter: lower values show
  EXPECT_DOUBLE_EQ(up.opacities[2].value, 370);
  EXPECT_DOUBLE_EQ(up.colours[0].value, -30);
  EXPECT_TRUE(checkTransferFunction(draggedTransfer(f, {-100'000, 7})).ok()) << "never collapses";
}

Workspace withLook() {
  Workspace w;
  w.know(ct());
  w.open({0, "a"}, 0);
  EXPECT_TRUE(w.open3d());
  return w;
}

TEST(WorkspaceLooks, StandBesideTheSlicesThroughOnePoint) {
  Workspace w = withLook();
  EXPECT_EQ(w.shown().size(), 4u);
  EXPECT_EQ(w.now().active, 3);
  EXPECT_EQ(w.tile(0).view, "axial");
  EXPECT_NE(lookOf(w.tile(3).scene), nullptr);
  w.undo();
  EXPECT_EQ(w.now().layout, Layout::Single) << "one step";
  w.redo();
  // Slices that were moved stay where they are when the look is asked for again.
  w.setActive(0);
  w.scroll(0, 3);
  const Arrangement moved = w.now();
  ASSERT_TRUE(w.openMpr());
  EXPECT_EQ(lookOf(w.tile(3).scene), nullptr);
  w.setActive(3);
  w.setScene(0, Gesture::Zoom, zoomed(w.tile(0).scene, {0, -50}, {0, 0}, 1));
  const Scene axial = w.tile(0).scene;
  ASSERT_TRUE(w.open3d());
  EXPECT_EQ(w.tile(0).scene, axial);
}

TEST(WorkspaceLooks, KeepTheCameraAndWhatBothHaveOfWindowAndInversion) {
  Workspace w = withLook();
  const std::vector<VolumeLook> looks = volumeLooks(ct());
  w.setLook(3, looks[0]);
  w.setScene(3, Gesture::Turn, turned(w.tile(3).scene, {40, 10}));
  w.setWindow(3, {300, 600, VoiFunction::Linear, ""});
  w.invert(3);
  const Camera chosen = w.tile(3).scene.camera;
  w.setLook(3, looks[1]);
  const auto& least = std::get<ProjectionLayer>(w.tile(3).scene.layers[0]);
  EXPECT_EQ(least.mode, ProjectionMode::Min);
  ASSERT_TRUE(least.window);
  EXPECT_EQ(least.window->width, 600);
  EXPECT_TRUE(least.invert);
  for (const VolumeLook& look : looks) {
    w.setLook(3, look);
    EXPECT_EQ(w.tile(3).scene.camera, chosen) << look.name;
  }
  w.resetView(3);
  EXPECT_EQ(w.tile(3).scene.camera, sceneOfLook(looks.back(), ct())->camera);
  w.resetView(3, 0.5);
  EXPECT_EQ(w.tile(3).scene.camera.zoom, 0.5) << "a tile half as wide as high shows all of the width";
}

TEST(WorkspaceLooks, AskedForAgainStayAsTheyAreAndMakeNoStep) {
  Workspace w = withLook();
  w.setScene(3, Gesture::Turn, turned(w.tile(3).scene, {40, 10}));
  const Tile chosen = w.tile(3);
  w.setActive(0);
  w.undo();
  const bool redo = w.canRedo();
  ASSERT_TRUE(w.open3d());
  EXPECT_EQ(w.now().active, 3);
  EXPECT_EQ(w.canRedo(), redo) << "where the eye is, is no edit";
  w.redo();
  EXPECT_EQ(w.tile(3), chosen);
  // From two side by side, where it stands on another place, it comes back.
  w.setLayout(Layout::Pair);
  w.setLayout(Layout::Quad);
  ASSERT_TRUE(w.open3d());
  EXPECT_EQ(w.tile(3), chosen);
}

// Two time points, or two series, turned together.
TEST(WorkspaceLooks, OfTwoSideBySideEachMayBeOneAndTheyTurnTogether) {
  Workspace w;
  for (const char* name : {"a", "b"}) {
    SourceFacts f = ct();
    f.id.name = name;
    w.know(f);
  }
  w.setLayout(Layout::Pair);
  w.open({0, "a"}, 0);
  ASSERT_TRUE(w.open3d());
  EXPECT_NE(lookOf(w.tile(0).scene), nullptr);
  EXPECT_EQ(w.now().layout, Layout::Pair);
  w.open({0, "b"}, 1);
  ASSERT_TRUE(w.open3d());
  EXPECT_EQ(*volumeOf(*lookOf(w.tile(1).scene)), "b");
  EXPECT_EQ(*volumeOf(*lookOf(w.tile(0).scene)), "a");
  w.setTogether(true);
  w.setScene(1, Gesture::Turn, turned(w.tile(1).scene, {30, 0}));
  EXPECT_DOUBLE_EQ(w.tile(0).scene.camera.azimuth_deg, -15);
}

TEST(WorkspaceLooks, WindowsOfLooksAndOfSlicesAreTheirOwn) {
  Workspace w = withLook();
  w.setLook(3, volumeLooks(ct())[0]);
  w.setWindow(0, {40, 80, VoiFunction::Linear, ""});
  EXPECT_FALSE(std::get<ProjectionLayer>(w.tile(3).scene.layers[0]).window);
  w.setWindow(3, {300, 600, VoiFunction::Linear, ""});
  EXPECT_EQ(sliceOf(w.tile(0).scene)->window->width, 80);
  EXPECT_EQ(std::get<ProjectionLayer>(w.tile(3).scene.layers[0]).window->width, 600);
  w.invert(3);
  EXPECT_FALSE(sliceOf(w.tile(0).scene)->invert);
  // Back to slices: they keep what they had.
  w.setActive(3);
  ASSERT_TRUE(w.openMpr());
  for (int t = 0; t < 4; ++t) EXPECT_EQ(sliceOf(w.tile(t).scene)->window->width, 80) << t;
}

TEST(WorkspaceLooks, FollowTheNextTimePoint) {
  Workspace w = withLook();
  w.know(test::axialFacts(0, "b"));
  w.replaceSource(3, {0, "b"});
  EXPECT_EQ(*volumeOf(*lookOf(w.tile(3).scene)), "b");
}

TEST(WorkspaceLooks, WhatHasNoInversionMakesNoStepOfUndo) {
  Workspace w = withLook();
  w.invert(3);  // a rendering
  w.undo();
  EXPECT_EQ(w.now().layout, Layout::Single);
}

// A linear ramp stays one when it is enlarged, and the middle stays in the middle.
TEST(Enlarged, IsLinearBetweenCentres) {
  Picture small(40, 20);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 40; ++x)
      small.at(x, y)[0] = static_cast<std::uint8_t>(5 * x),
                  small.at(x, y)[1] = static_cast<std::uint8_t>(10 * y);
  const double per = 61.0 / 20;
  const Picture large = enlarged(small, per, 120, 61);
  ASSERT_EQ(large.width, 120);
  ASSERT_EQ(large.height, 61);
  for (int y = 2; y < 59; ++y)
    for (int x = 2; x < 118; ++x) {
      const double sx = (x + 0.5 - 60) / per + 20 - 0.5, sy = (y + 0.5 - 30.5) / per + 10 - 0.5;
      EXPECT_NEAR(large.at(x, y)[0], 5 * std::clamp(sx, 0.0, 39.0), 0.6);
      EXPECT_NEAR(large.at(x, y)[1], 10 * std::clamp(sy, 0.0, 19.0), 0.6);
    }
  EXPECT_EQ(enlarged(small, 1, 40, 20), small);
}

}  // namespace
}  // namespace vernier::ui
