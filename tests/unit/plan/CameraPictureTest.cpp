// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/CameraPicture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "Grids.h"
#include "vernier/base/Random.h"

namespace vernier {
namespace {

constexpr double kPi = std::numbers::pi;
const CameraBox kBox{PatientPoint(10, -20, 30), 200};

CameraPicture pictureOf(const Camera& camera, int width = 640, int height = 480,
                        const CameraBox& box = kBox) {
  const Result<CameraPicture> p = cameraPicture(camera, View{width, height}, box);
  EXPECT_TRUE(p.ok());
  return *p;
}

Camera cameraOf(Projection projection, double azimuth_deg = 0, double elevation_deg = 0) {
  Camera c;
  c.projection = projection, c.azimuth_deg = azimuth_deg, c.elevation_deg = elevation_deg;
  return c;
}

void expectNear(glm::dvec3 a, glm::dvec3 b, double tolerance) {
  EXPECT_LE(glm::length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << " / " << b.x << " " << b.y << " " << b.z;
}

// The peer's definition: eye direction (sin a cos e, -cos a cos e, sin e), right (cos a, sin a, 0),
// up (-sin a sin e, cos a sin e, cos e); image height D; eye at (D/2)/sin(fov/2).
TEST(CameraPicture, IsTheCameraOfThePeers) {
  for (const double azimuth : {0.0, 4.0, 30.0, 123.0, -90.0})
    for (const double elevation : {0.0, 20.0, -75.0}) {
      const double a = azimuth * kPi / 180, e = elevation * kPi / 180;
      const glm::dvec3 eye(std::sin(a) * std::cos(e), -std::cos(a) * std::cos(e), std::sin(e));
      const glm::dvec3 right(std::cos(a), std::sin(a), 0),
          up(-std::sin(a) * std::sin(e), std::cos(a) * std::sin(e), std::cos(e));
      const CameraPicture o = pictureOf(cameraOf(Projection::Orthographic, azimuth, elevation));
      expectNear(o.right.v, right, 1e-15);
      expectNear(o.up.v, up, 1e-15);
      expectNear(o.forward.v, -eye, 1e-15);
      EXPECT_NEAR(o.mmPerPixel(), 200.0 / 480, 1e-12);
      const CameraPicture p = pictureOf(cameraOf(Projection::Perspective, azimuth, elevation));
      expectNear(p.eye.p, kBox.centre.p + eye * (100 / std::sin(15 * kPi / 180)), 1e-10);
      // The box's sphere just fits: the ray through the picture's top edge touches it.
      const PatientRay top = p.ray(320, 0);
      EXPECT_NEAR(length(cross(kBox.centre - top.origin, top.direction)), 100, 1e-9);
    }
}

TEST(CameraPicture, RightHandedAndUnitForEveryAngle) {
  for (int n = 0; n < 200; ++n) {
    Camera c = cameraOf(Projection::Perspective, 720 * randomUnit(1, 3 * n) - 360,
                        180 * randomUnit(1, 3 * n + 1) - 90);
    c.roll_deg = 360 * randomUnit(1, 3 * n + 2);
    const CameraPicture p = pictureOf(c);
    expectNear(cross(p.right, p.up).v, -p.forward.v, 1e-14);
    EXPECT_NEAR(length(p.right), 1, 1e-14);
    EXPECT_NEAR(dot(p.right, p.up), 0, 1e-14);
  }
}

TEST(CameraPicture, TheCentresRayPassesThroughTheTarget) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
    Camera c = cameraOf(projection, 33, 44);
    const CameraPicture p = pictureOf(c);
    expectNear(p.ray(320, 240).at(p.targetDistance_mm).p, kBox.centre.p, 1e-10);
    c.target = PatientPoint(1, 2, 3), c.distance_mm = 7.5;
    const CameraPicture q = pictureOf(c);
    expectNear(q.ray(320, 240).at(7.5).p, {1, 2, 3}, 1e-12);
    c.pan_mm = {4, -5};
    const CameraPicture r = pictureOf(c);
    expectNear(r.ray(320, 240).at(7.5).p, glm::dvec3(1, 2, 3) + 4.0 * r.right.v - 5.0 * r.up.v, 1e-12);
  }
}

// Pixel -> ray -> point -> pixel, at random places; depth is measured along forward, distance along the ray.
TEST(CameraPicture, PointsOfARayComeBackToItsPixel) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (int n = 0; n < 300; ++n) {
      auto r = [&, draw = std::uint64_t{0}]() mutable {
        return randomUnit(static_cast<std::uint64_t>(n), draw++);
      };
      Camera c = cameraOf(projection, 360 * r(), 180 * r() - 90);
      c.roll_deg = 360 * r(), c.zoom = 0.5 + 3 * r(), c.fov_deg = 5 + 120 * r(),
      c.pan_mm = {50 * r(), 50 * r()};
      const CameraPicture p = pictureOf(c);
      const double x = 640 * r(), y = 480 * r(), t = 1 + 500 * r();
      const PatientRay ray = p.ray(x, y);
      EXPECT_NEAR(length(ray.direction), 1, 1e-14);
      const glm::dvec4 q = p.pixelFromPatient() * glm::dvec4(ray.at(t).p, 1);
      EXPECT_NEAR(q.x / q.w, x, 1e-8);
      EXPECT_NEAR(q.y / q.w, y, 1e-8);
      EXPECT_NEAR(q.z * p.rayPerDepth(x, y), t, 1e-9);
      EXPECT_NEAR(q.w, projection == Projection::Perspective ? q.z : 1, 1e-9);
    }
}

// The lattice's origin: the eye point, or one plane before the box for all pixels.
TEST(CameraPicture, RaysBeginAtTheEyeOrOnItsPlane) {
  const CameraPicture p = pictureOf(cameraOf(Projection::Perspective, 30, 20));
  const CameraPicture o = pictureOf(cameraOf(Projection::Orthographic, 30, 20));
  for (const glm::dvec2 pixel : {glm::dvec2(0.5, 0.5), glm::dvec2(639.5, 3.5), glm::dvec2(320, 479.5)}) {
    EXPECT_EQ(p.ray(pixel.x, pixel.y).origin, p.eye);
    EXPECT_NEAR(dot(o.ray(pixel.x, pixel.y).origin - o.eye, o.forward), 0, 1e-11);
    EXPECT_NEAR(dot(o.ray(pixel.x, pixel.y).origin - kBox.centre, o.forward), -200, 1e-11);
  }
}

TEST(CameraPicture, ZoomHeightAndFieldOfView) {
  Camera c = cameraOf(Projection::Orthographic);
  c.zoom = 2;
  EXPECT_NEAR(pictureOf(c).mmPerPixel(), 100.0 / 480, 1e-13);
  c.height_mm = 50;
  EXPECT_NEAR(pictureOf(c).mmPerPixel(), 25.0 / 480, 1e-13);
  c = cameraOf(Projection::Perspective);
  const PatientPoint eye = pictureOf(c).eye;
  c.zoom = 3;
  EXPECT_EQ(pictureOf(c).eye, eye);  // magnifies, does not move
  EXPECT_NEAR(pictureOf(c).pixelStep, 2 * std::tan(15 * kPi / 180) / 3 / 480, 1e-15);
  c.zoom = 1, c.height_mm = 60, c.fov_deg = 50;
  const CameraPicture p = pictureOf(c);
  EXPECT_NEAR(p.mmPerPixel() * 480, 60, 1e-11);  // the target's plane is that high
  EXPECT_NEAR(p.targetDistance_mm, 30 / std::tan(25 * kPi / 180), 1e-11);
}

TEST(CameraPicture, RollTurnsTheCameraClockwise) {
  Camera c = cameraOf(Projection::Orthographic);
  c.roll_deg = 90;
  const CameraPicture p = pictureOf(c);
  expectNear(p.up.v, {1, 0, 0}, 1e-15);  // what was at the right is now on top
  expectNear(p.right.v, {0, 0, -1}, 1e-15);
  EXPECT_EQ(edgeLetters(p), (EdgeLetters{"H", "F", "L", "R"}));
  // From the front: the patient's left is on the right of the picture.
  EXPECT_EQ(edgeLetters(pictureOf(cameraOf(Projection::Perspective))), (EdgeLetters{"R", "L", "H", "F"}));
  // From the patient's left side: anterior on the left of the picture.
  EXPECT_EQ(edgeLetters(pictureOf(cameraOf(Projection::Perspective, 90))), (EdgeLetters{"A", "P", "H", "F"}));
}

TEST(CameraPicture, FarFromTheOriginPixelsStayWherePointsAre) {
  Camera c = cameraOf(Projection::Perspective, 30, 20);
  const CameraBox far{PatientPoint(1e6, -1e6, 1e6), 200};
  const CameraPicture p = pictureOf(c, 640, 480, far);
  for (const double x : {3.5, 320.0, 600.5}) {
    const glm::dvec4 q = p.pixelFromPatient() * glm::dvec4(p.ray(x, 100.5).at(400).p, 1);
    EXPECT_NEAR(q.x / q.w, x, 1e-5);  // NUMERICS A14: 0.01 mm
  }
}

TEST(CameraPicture, TheBoxIsThatOfVoxelCentresOrOfTheSurfaces) {
  GridGeometry grid;
  grid.columns = 11, grid.rows = 21, grid.slices = 5;
  grid.patientFromVoxel.linear = glm::dmat3({1, 0, 0}, {0, 2, 0}, {0, 0, 10});
  grid.patientFromVoxel.translation = {100, 0, 0};
  const CameraBox box = cameraBox(grid);
  expectNear(box.centre.p, {105, 20, 20}, 1e-12);
  EXPECT_NEAR(box.diagonal_mm, std::sqrt(100.0 + 1600 + 1600), 1e-12);

  MeshBuilder b;
  b.triangle(b.vertex({0, 0, 0}), b.vertex({3, 0, 0}), b.vertex({0, 4, 0}));
  Sources sources;
  sources.meshes["tool"] = *b.finish();
  SurfaceLayer tool;
  tool.source = "tool";
  Scene scene;
  scene.layers = {tool};
  EXPECT_NEAR(cameraBox(scene, sources)->diagonal_mm, 5, 1e-12);
  tool.pose.translation = {0, 0, 12};
  scene.layers.emplace_back(tool);
  EXPECT_NEAR(cameraBox(scene, sources)->diagonal_mm, 13, 1e-12);
  expectNear(cameraBox(scene, sources)->centre.p, {1.5, 2, 6}, 1e-12);
  EXPECT_EQ(cameraBox(Scene{}, sources).error().code, ErrorCode::SceneInvalid);
}

TEST(CameraPicture, WhatCannotBeSeenIsRefusedWithItsKey) {
  const auto refused = [](const Camera& c, const char* key, const CameraBox& box = kBox) {
    const auto p = cameraPicture(c, View{64, 64}, box);
    ASSERT_FALSE(p.ok()) << key;
    EXPECT_EQ(p.error().code, ErrorCode::SceneInvalid);
    EXPECT_EQ(p.error().where, key);
  };
  Camera c;
  c.zoom = 0;
  refused(c, "/camera/zoom");
  c = {}, c.fov_deg = 180;
  refused(c, "/camera/fov_deg");
  c = {}, c.azimuth_deg = std::nan("");
  refused(c, "/camera/azimuth_deg");
  c = {}, c.height_mm = -1;
  refused(c, "/camera/height_mm");
  c = {}, c.distance_mm = HUGE_VAL;
  refused(c, "/camera/distance_mm");
  c = {}, c.near_mm = -1;
  refused(c, "/camera/near_mm");
  c = {}, c.target = PatientPoint(0, std::nan(""), 0);
  refused(c, "/camera/target_mm");
  c = {}, c.zoom = 1e-320;
  refused(c, "/camera/zoom");
  refused({}, "", {PatientPoint(0, 0, 0), 0});
  EXPECT_FALSE(cameraPicture({}, View{0, 5}, kBox).ok());
}

}  // namespace
}  // namespace vernier
