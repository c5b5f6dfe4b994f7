// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses put, dragged, turned and scaled: each against what must become of points of the lens.
#include "vernier/plan/LensEdits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "vernier/plan/SceneJson.h"

namespace vernier {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

VolumeLayer volume() {
  VolumeLayer l;
  l.source = "ct";
  return l;
}

Scene withLens(LensLayer lens) {
  Scene s;
  s.layers.emplace_back(volume());
  s.layers.emplace_back(std::move(lens));
  return s;
}

const LensLayer& lensIn(const Scene& s) { return std::get<LensLayer>(s.layers.at(1)); }

// A lens whose frame lies askew and whose middle is not the frame's origin.
LensLayer askew() {
  LensLayer l;
  l.shape = BoxShape{MeshPoint(3, -2, 5), {10, 20, 30}};
  l.pose = {glm::dmat3(0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0.1, 1.5), {100, 20, -7}};
  return l;
}

void expectNear(const PatientPoint& a, const PatientPoint& b) { EXPECT_LT(length(a - b), 1e-11); }

template <class T>
void expectInvalid(const Result<T>& r, const std::string& where) {
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::SceneInvalid);
  EXPECT_EQ(r.error().where, where);
}

TEST(LensEdits, PresetsShowWhatTheirNamesSay) {
  SliceLayer slice;
  slice.source = "ct";
  const PatientPoint at(1, 2, 3);
  const LensLayer bone = lensAt(LensPreset::Bone, volume(), at, 25);
  EXPECT_EQ(std::get<SphereShape>(bone.shape).radius_mm, 25);
  EXPECT_EQ(middleOf(bone), at);
  EXPECT_EQ(std::get<IsosurfaceLayer>(bone.inner).source, "ct");
  const LensLayer vessels = lensAt(LensPreset::Vessels, volume(), at, 25);
  EXPECT_EQ(std::get<ProjectionLayer>(vessels.inner).mode, ProjectionMode::Max);
  EXPECT_EQ(std::get<ProjectionLayer>(vessels.inner).source, "ct");
  EXPECT_TRUE(std::holds_alternative<CutOut>(lensAt(LensPreset::CutOut, volume(), at, 25).inner));
  EXPECT_EQ(std::get<SliceLook>(lensAt(LensPreset::Bone, slice, at, 25).inner).window->width, 1800);
}

TEST(LensEdits, DefaultInnersDifferFromWhatIsAround) {
  ProjectionLayer mip;
  mip.source = "v";
  IsosurfaceLayer iso;
  iso.source = "v";
  SliceLayer slice;
  slice.source = "v";
  EXPECT_TRUE(std::holds_alternative<IsosurfaceLayer>(defaultLensInner(volume(), true)));
  EXPECT_EQ(std::get<VolumeLayer>(defaultLensInner(mip, true)).source, "v");
  EXPECT_EQ(std::get<ProjectionLayer>(defaultLensInner(iso, true)).source, "v");
  EXPECT_FALSE(std::get<SliceLook>(defaultLensInner(slice, true)).invert);
  EXPECT_TRUE(std::get<SliceLook>(defaultLensInner(slice, false)).invert);
}

TEST(LensEdits, TrajectoriesRunFromSkinToTarget) {
  const LensLayer l = trajectoryLens(PatientPoint(10, 20, 30), PatientPoint(-5, 0, 70), 12, 3);
  const auto& cone = std::get<ConeShape>(l.shape);
  expectNear(l.pose * cone.from, PatientPoint(10, 20, 30));
  expectNear(l.pose * cone.to, PatientPoint(-5, 0, 70));
  EXPECT_EQ(cone.fromRadius_mm, 12);
  EXPECT_EQ(cone.toRadius_mm, 3);
  EXPECT_TRUE(std::holds_alternative<CutOut>(l.inner));
}

TEST(LensEdits, PlacingAndMovingShiftAllPointsAlike) {
  const Scene before = withLens(askew());
  const PatientPoint corner = lensIn(before).pose * MeshPoint(8, 8, 20);
  const Result<Scene> moved = moveLens(before, 1, PatientVec(1, -2, 4));
  ASSERT_TRUE(moved.ok());
  expectNear(lensIn(*moved).pose * MeshPoint(8, 8, 20), corner + PatientVec(1, -2, 4));
  const Result<Scene> placed = placeLens(before, 1, PatientPoint(-9, 8, 7));
  ASSERT_TRUE(placed.ok());
  expectNear(middleOf(lensIn(*placed)), PatientPoint(-9, 8, 7));
  EXPECT_EQ(lensIn(*placed).pose.linear, askew().pose.linear);
  EXPECT_EQ(lensIn(*placed).shape, askew().shape);
  EXPECT_EQ(before, withLens(askew()));  // what undo goes back to is untouched
}

TEST(LensEdits, TurningKeepsTheMiddleAndAllDistances) {
  const Scene before = withLens(askew());
  const PatientPoint middle = middleOf(askew());
  const Result<Scene> turned = turnLens(before, 1, PatientVec(0, 0, 2), 90);
  ASSERT_TRUE(turned.ok());
  expectNear(middleOf(lensIn(*turned)), middle);
  for (const MeshPoint& p : {MeshPoint(0, 0, 0), MeshPoint(8, 8, 20), MeshPoint(-4, 1, 2)}) {
    const PatientVec arm = askew().pose * p - middle;
    // Seen from above the z axis, counterclockwise: x goes to y, y to -x.
    expectNear(lensIn(*turned).pose * p, middle + PatientVec(-arm.v.y, arm.v.x, arm.v.z));
  }
  Result<Scene> round = before;
  for (int n = 0; n < 360; ++n) round = turnLens(*std::move(round), 1, PatientVec(1, 2, -3), 1);
  for (const MeshPoint& p : {MeshPoint(0, 0, 0), MeshPoint(8, 8, 20)})
    expectNear(lensIn(*round).pose * p, askew().pose * p);
}

TEST(LensEdits, ScalingIsAlongTheLensesOwnAxesAboutItsMiddle) {
  const Result<Scene> scaled = scaleLens(withLens(askew()), 1, {2, 1, 0.5});
  ASSERT_TRUE(scaled.ok());
  expectNear(middleOf(lensIn(*scaled)), middleOf(askew()));
  // The corner at (5, 10, 15) from the box's centre stands where one at (10, 10, 7.5) stood.
  expectNear(lensIn(*scaled).pose * MeshPoint(8, 8, 20), askew().pose * MeshPoint(13, 8, 12.5));
}

TEST(LensEdits, DraggingFollowsThePointer) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
    Camera camera;
    camera.azimuth_deg = 40, camera.elevation_deg = -15, camera.roll_deg = 20, camera.projection = projection;
    View view;
    view.width_px = 640, view.height_px = 480;
    const Result<CameraPicture> c = cameraPicture(camera, view, {PatientPoint(100, 20, 0), 200});
    ASSERT_TRUE(c.ok());
    const auto pixelOf = [&](const PatientPoint& p) {
      const glm::dvec4 q = c->pixelFromPatient() * glm::dvec4(p.p, 1);
      return glm::dvec2(q) / q.w;
    };
    const glm::dvec2 by(31, -17), at = pixelOf(middleOf(askew()));
    const Result<Scene> dragged = dragLens(withLens(askew()), 1, *c, at, at + by);
    ASSERT_TRUE(dragged.ok()) << dragged.error().text();
    EXPECT_LT(glm::distance(pixelOf(middleOf(lensIn(*dragged))), at + by), 1e-9);
    EXPECT_NEAR(dot(c->forward, middleOf(lensIn(*dragged)) - middleOf(askew())), 0, 1e-9);
  }
}

TEST(LensEdits, LensesNeedSomethingToLookInto) {
  Scene scene;
  EXPECT_EQ(layerBehindLens(scene), nullptr);
  expectInvalid(addLens(scene, askew()), "/layers/0");
  scene.layers.emplace_back(volume());
  const Result<Scene> with = addLens(scene, askew());
  ASSERT_TRUE(with.ok());
  ASSERT_EQ(with->layers.size(), 2u);
  EXPECT_EQ(layerBehindLens(*with), &with->layers[0]);
  EXPECT_EQ(*removeLens(*with, 1), scene);
  EXPECT_EQ(*parseScene(writeScene(*with)), *with);
}

TEST(LensEdits, WhatMakesNoSenseIsRefused) {
  const Scene s = withLens(askew());
  expectInvalid(moveLens(s, 0, PatientVec(1, 0, 0)), "/layers/0");
  expectInvalid(removeLens(s, 2), "/layers/2");
  expectInvalid(setLensInner(s, 7, CutOut{}), "/layers/7");
  expectInvalid(moveLens(s, 1, PatientVec(kInf, 0, 0)), "/layers/1/pose");
  expectInvalid(placeLens(s, 1, PatientPoint(std::nan(""), 0, 0)), "/layers/1/pose");
  expectInvalid(turnLens(s, 1, PatientVec(0, 0, 0), 10), "/layers/1/pose");
  expectInvalid(turnLens(s, 1, PatientVec(0, 0, 1), kInf), "/layers/1/pose");
  for (const double bad : {0.0, -1.0, kInf}) expectInvalid(scaleLens(s, 1, {1, bad, 1}), "/layers/1/pose");
}

}  // namespace
}  // namespace vernier
