// SPDX-License-Identifier: GPL-3.0-or-later
// Iso-surfaces and lights by hand and against closed forms; where edges of the picture run.
#include <cmath>
#include <numbers>

#include "Layers.h"
#include "VolumeScenes.h"
#include "vernier/base/Random.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

constexpr Rgb kRed{1, 0, 0};
// Told apart: ambient red, diffuse green, specular in all three.
Material plainMaterial() { return {0.3, 0.5, 0.1, 2, {1, 0, 0}, {0, 1, 0}}; }

IsosurfaceLayer isoAt(double level) {
  IsosurfaceLayer layer;
  layer.level = level, layer.material = plainMaterial();
  return layer;
}
const double kRamp[4] = {0, 1, 2, 3};  // the value is y

TEST(IsosurfaceReference, APlane) {
  VolumeScene s = fourVoxels(isoAt(1.3), kRamp);
  s.scene.background = {0.2, 0.4, 0.6};
  expectPixel(s, {0.4, 0.6, 0.1}, 1e-12);  // faces the eye, where the light is
  EXPECT_EQ(pixelOf(s).value, 1.3);
  EXPECT_TRUE(pixelOf(s).covered);
  VolumeScene above = s;
  above.iso().level = 3.5;
  expectPixel(above, {0.2, 0.4, 0.6}, 1e-15);
  EXPECT_FALSE(pixelOf(above).covered);
  // Tools before and behind it.
  VolumeScene tools = s;
  tools.sheet(1.5, 1, kRed);
  expectPixel(tools, {0.4, 0.6, 0.1}, 1e-12);
  tools.sheet(1.2, 0.25, kRed);
  expectPixel(tools, {0.25 + 0.3, 0.45, 0.075}, 1e-12);
  tools.sheet(1, 1, {0, 0, 1});
  expectPixel(tools, {0, 0, 1}, 1e-12);
  EXPECT_TRUE(std::isnan(pixelOf(tools).value));
  VolumeScene behind = above;
  behind.sheet(2, 0.5, kRed);
  expectPixel(behind, {0.6, 0.2, 0.3}, 1e-12);
}

// A ray that begins within shows a face turned to the eye, whatever the field does there.
TEST(IsosurfaceReference, AFaceWhereTheRayBeginsWithin) {
  GridGeometry g = gridOf(4, 4, 4);
  VolumeScene s = volumeScene(floatVolume(g, [](auto i, auto, auto) { return i; }), isoAt(0.5));
  s.scene.camera.height_mm = 1;
  const glm::dvec3 face(0.4, 0.6, 0.1);
  expectPixel(s, face, 1e-12);  // the box
  s.scene.crop = CropBox{VoxelPoint(-1, 0.5, -1), VoxelPoint(9, 9, 9)};
  expectPixel(s, face, 1e-12);
  s.clipBefore(1.7);
  expectPixel(s, face, 1e-12);
  s.scene.camera.near_mm = 6;
  expectPixel(s, face, 1e-12);
  // The level is reached at the beginning exactly.
  VolumeScene at = fourVoxels(isoAt(0), kRamp);
  expectPixel(at, face, 1e-12);
  // Data that begin within: padding up to the third voxel.
  VolumeInfo info;
  info.grid = gridOf(2, 4, 2);
  info.noData = NoDataRange{-5, -5};
  VolumeScene padded = volumeScene(
      floatVolume(info,
                  [](auto i, auto j, auto) { return j < 2 ? -5.0 : 1.0 + 10 * static_cast<double>(i); }),
      isoAt(1));
  padded.scene.camera.height_mm = 1;
  expectPixel(padded, face, 1e-7);
}

// The distance to a point, sampled, and what it crosses found by bisection of the trilinear field.
TEST(IsosurfaceReference, ASphere) {
  constexpr int n = 24;
  const auto distance = [](double i, double j, double k) {
    return 20 - glm::length(glm::dvec3(i, j, k) - glm::dvec3(11.3, 11.7, 11.1));
  };
  const auto volume = floatVolume(gridOf(n, n, n), [&](auto i, auto j, auto k) { return distance(i, j, k); });
  VolumeScene s = volumeScene(volume, isoAt(12));  // radius 8
  s.view = {64, 64};
  s.scene.camera.height_mm = 24;
  s.scene.lights = {{PatientVec(1, -1, 2), {1, 1, 1}}};
  s.iso().material = {0, 1, 0, 1, {1, 1, 1}, {1, 1, 1}};
  const glm::dvec3 light = glm::normalize(glm::dvec3(1, -1, 2));
  int hits = 0;
  for (std::size_t y = 4; y < 64; y += 7)
    for (std::size_t x = 3; x < 64; x += 7) {
      const double px = 11.5 + 24 * (static_cast<double>(x) + 0.5 - 32) / 64,
                   pz = 11.5 - 24 * (static_cast<double>(y) + 0.5 - 32) / 64;
      const auto field = [&](double qx, double qy, double qz) {
        const double fx = std::floor(qx), fy = std::floor(qy), fz = std::floor(qz);
        double sum = 0;
        for (int c = 0; c < 8; ++c) {
          const double wx = c & 1 ? qx - fx : 1 - qx + fx, wy = c & 2 ? qy - fy : 1 - qy + fy,
                       wz = c & 4 ? qz - fz : 1 - qz + fz;
          if (wx * wy * wz > 0)
            sum += wx * wy * wz *
                   volume->modality(static_cast<std::int64_t>(fx) + (c & 1),
                                    static_cast<std::int64_t>(fy) + (c >> 1 & 1),
                                    static_cast<std::int64_t>(fz) + (c >> 2));
        }
        return sum;
      };
      double from = -1, to = -1;
      for (double t = 0; t < 22.99 && to < 0; t += 0.01) field(px, t, pz) >= 12 ? to = t : from = t;
      const ReferencePixel got = pixelOf(s, x + 64 * y);
      if (to < 0) {
        EXPECT_TRUE(std::isnan(got.value));
        continue;
      }
      for (int step = 0; step < 60; ++step) {
        const double mid = 0.5 * (from + to);
        (field(px, mid, pz) >= 12 ? to : from) = mid;
      }
      ++hits;
      glm::dvec3 d(field(px + 1, to, pz) - field(px - 1, to, pz),
                   field(px, to + 1, pz) - field(px, to - 1, pz),
                   field(px, to, pz + 1) - field(px, to, pz - 1));
      d = glm::normalize(d);
      if (d.y > 0) d = -d;  // to the viewer, who looks along y
      EXPECT_NEAR(got.rgba.x, std::max(0.0, glm::dot(d, light)), 1e-9);
      // And near the true sphere's own normal.
      const glm::dvec3 sphere = glm::normalize(glm::dvec3(px, to, pz) - glm::dvec3(11.3, 11.7, 11.1));
      EXPECT_NEAR(got.rgba.x, std::max(0.0, glm::dot(sphere, light)), 0.02);
    }
  EXPECT_GT(hits, 20);
}

// v = y on voxels of 1 x 2 x 0.5 mm, turned by 30 degrees about z: the gradient points along the turned y
// axis, half a unit per mm, whichever way.
TEST(IsosurfaceReference, LightsByHand) {
  GridGeometry g = gridOf(8, 8, 8, {1, 2, 0.5});
  const double c = std::cos(std::numbers::pi / 6), h = std::sin(std::numbers::pi / 6);
  g.patientFromVoxel.linear = glm::dmat3(c, h, 0, -h, c, 0, 0, 0, 1) * g.patientFromVoxel.linear;
  for (const bool falling : {false, true}) {
    VolumeScene s =
        volumeScene(floatVolume(g, [&](auto, auto j, auto) { return falling ? 7 - j : j; }), isoAt(3));
    s.scene.camera.height_mm = 1, s.scene.camera.distance_mm = 40;
    if (falling) s.scene.camera.azimuth_deg = 180;
    const glm::dvec3 eye(0, falling ? 1 : -1, 0), n = falling ? glm::dvec3(-h, c, 0) : glm::dvec3(h, -c, 0);
    s.iso().material.power = 5;
    const auto expected = [&](glm::dvec3 l, glm::dvec3 colour) {
      l = glm::normalize(l);
      const glm::dvec3 half = glm::normalize(l + eye);
      return colour * (glm::dvec3(0, 0.5, 0) * std::max(0.0, glm::dot(n, l)) +
                       0.1 * std::pow(std::max(0.0, glm::dot(n, half)), 5));
    };
    const glm::dvec3 ambient(0.3, 0, 0);
    expectPixel(s, ambient + expected(eye, {1, 1, 1}), 1e-12);  // none: a white one at the eye
    s.scene.lights = {{std::nullopt, {0.5, 0.6, 0.7}}};
    expectPixel(s, ambient + expected(eye, {0.5, 0.6, 0.7}), 1e-12);
    const glm::dvec3 side = falling ? glm::dvec3(-3, 2, 1) : glm::dvec3(3, -2, 1);
    s.scene.lights.push_back({PatientVec(side), {0.2, 1, 0.3}});
    expectPixel(s, ambient + expected(eye, {0.5, 0.6, 0.7}) + expected(side, {0.2, 1, 0.3}), 1e-12);
    s.scene.lights = {{PatientVec(-n), {1, 1, 1}}};  // from behind
    expectPixel(s, ambient + expected(-n, {1, 1, 1}), 1e-12);
    s.scene.lights = {{PatientVec(-eye), {1, 1, 1}}};  // against the eye: no halfway
    expectPixel(s, ambient, 1e-12);
    s.iso().material.ambient = 3;  // clamped
    expectPixel(s, {1, 0, 0}, 1e-12);
    s.scene.lights = {{PatientVec(0, 0, 0), {1, 1, 1}}};
    EXPECT_EQ(refusalOf(s).code, ErrorCode::SceneInvalid);
  }
}

// Central differences along pieces as cubics and point by point are the same; positions are held at the box.
TEST(IsosurfaceReference, GradientsAlongAPiece) {
  GridGeometry g = gridOf(5, 4, 6, {0.7, 1.1, 2});
  const auto volume = floatVolume(g, [](auto i, auto j, auto k) {
    return randomUnit(5, static_cast<std::uint64_t>(i + 5 * j + 20 * k));
  });
  const Gradient gradient(*volume, Interpolation::Linear);
  Piece piece;
  for (std::uint64_t n = 0; n < 300; ++n) {
    const auto draw = [&](std::uint64_t k) { return randomUnit(n, k); };
    const glm::dvec3 cell(std::floor(4 * draw(0)), std::floor(3 * draw(1)), std::floor(5 * draw(2)));
    const glm::dvec3 a = cell + glm::dvec3(draw(3), draw(4), draw(5)),
                     b = cell + glm::dvec3(draw(6), draw(7), draw(8));
    const RayPart part{piece, 0, 1, 0, a, b - a};
    const Gradient::Along along(gradient, part);
    for (double u : {0.0, 0.3, 1.0})
      EXPECT_LT(glm::length(along(u) - gradient.at(a + u * (b - a))), 1e-13) << n;
    for (double u : along.turns({0.6, 0, 0.8})) EXPECT_NEAR(glm::dot(along(u), {0.6, 0, 0.8}), 0, 1e-12);
  }
  const auto at = [&](int i, int j, int k) { return volume->modality(i, j, k); };
  const glm::dvec3 corner = gradient.at({0, 0, 5});
  EXPECT_NEAR(corner.x, 0.5 * (at(1, 0, 5) - at(0, 0, 5)) / 0.7, 1e-12);
  EXPECT_NEAR(corner.y, 0.5 * (at(0, 1, 5) - at(0, 0, 5)) / 1.1, 1e-12);
  EXPECT_NEAR(corner.z, 0.5 * (at(0, 0, 5) - at(0, 0, 4)) / 2, 1e-12);
}

TEST(IsosurfaceReference, WhatItCannotDrawIsRefused) {
  VolumeScene s = fourVoxels(isoAt(1), kRamp);
  ReferenceOptions sampled;
  sampled.kind = ErrorKind::Implementation;
  EXPECT_EQ(refusalOf(s, sampled).code, ErrorCode::NotBuiltYet);
  VolumeScene combined = s;
  combined.iso().combiner = "two-lights";
  EXPECT_EQ(refusalOf(combined).code, ErrorCode::NotBuiltYet);
  VolumeScene level = s;
  level.iso().level = std::nan("");
  EXPECT_EQ(refusalOf(level).code, ErrorCode::SceneInvalid);
  level.iso().level.reset();  // the middle of the range
  EXPECT_EQ(pixelOf(level).value, 1.5);
}

}  // namespace
}  // namespace vernier::quality
