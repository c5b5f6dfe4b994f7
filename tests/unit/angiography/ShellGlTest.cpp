// SPDX-License-Identifier: GPL-3.0-or-later
// What shells on OpenGL cost, the two ways of the paper, and what is drawn in which way.
#include <gmock/gmock.h>

#include "GlShells.h"
#include "ShellCases.h"

namespace vernier::test {
namespace {

using ::testing::HasSubstr;

std::shared_ptr<const Mesh> tetrahedron(double size_mm) {
  MeshBuilder b;
  const auto o = b.vertex({0, 0, 0}), x = b.vertex({size_mm, 0, 0}), y = b.vertex({0, size_mm, 0}),
             z = b.vertex({0, 0, size_mm});
  b.triangle(o, y, x), b.triangle(o, x, z), b.triangle(o, z, y), b.triangle(x, y, z);
  return *b.finish();
}

std::uint64_t trianglesOf(const ShellCase& c) {
  std::uint64_t n = 0;
  for (const native::Shell& s : c.job().shells) n += s.mesh ? s.mesh->triangles().size() : 0;
  return n;
}

TEST(ShellsGl, AToolCostsOneColourPassAndOneDepthPassPerShellThatItOverlaps) {
  VERNIER_NEEDS_GL(device);
  ShellCase c;
  const std::uint64_t shells = trianglesOf(c);
  EXPECT_EQ(c.draw("shells.gl")->counters.triangles, shells);  // no depth pre-pass without tools
  const PatientPoint middle = c.sources.volumes["v"]->grid().centre();
  c.addTool(tetrahedron(5), middle);
  EXPECT_EQ(c.draw("shells.gl")->counters.triangles, shells + 4 * (5 + 1));
  c.shells().disabled = {0, 4};
  const std::uint64_t fewer = trianglesOf(c);
  EXPECT_LT(fewer, shells);
  EXPECT_EQ(c.draw("shells.gl")->counters.triangles, fewer + 4 * (3 + 1));
  // Beside the shells on the screen: its colour alone.
  std::get<SurfaceLayer>(c.scene.layers[1]).pose.translation = (middle + 60 * c.job().camera.right).p;
  EXPECT_EQ(c.draw("shells.gl")->counters.triangles, fewer + 4);
  c.shells().mode = ShellsMode::Sum;
  std::get<SurfaceLayer>(c.scene.layers[1]).pose.translation = middle.p;
  EXPECT_EQ(c.draw("shells.gl")->counters.triangles, fewer + 4 * 2);
}

TEST(ShellsGl, ATurnOfTheCameraUploadsNoShellAgain) {
  VERNIER_NEEDS_GL(device);
  ShellCase c;
  ASSERT_TRUE(c.draw("shells.gl").ok());
  c.scene.camera.azimuth_deg += 4;
  EXPECT_EQ(c.draw("shells.gl")->counters.bytesUploaded, 0u);
  c.shells().a = 0.4, c.shells().beta0 = 0.2;
  EXPECT_EQ(c.draw("shells.gl")->counters.bytesUploaded, 0u);
}

// Colour for each shell, or full brightness under a linear fog (sections 2 and 3 of the paper).
TEST(ShellsGl, BothRoutesToBrightnessAgree) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const double a : {0.0, 0.9}) {
      ShellCase c;
      c.scene.camera.projection = projection;
      c.shells().a = a, c.shells().b = 0.2, c.shells().beta0 = 0.1;
      const native::ShellsJob job = c.job();
      Images colours, fog;
      ASSERT_TRUE(angiography::drawGlShells(*device, job, {}, colours, {}).ok());
      ASSERT_TRUE(angiography::drawGlShells(
                      *device, job, {angiography::Maximum::DepthBuffer, angiography::Route::Fog}, fog, {})
                      .ok());
      float most = 0;
      for (std::size_t n = 0; n < colours.colour.size(); n += 4) {
        ASSERT_NEAR(colours.colour[n], fog.colour[n], 2e-6);
        most = std::max(most, fog.colour[n]);
      }
      EXPECT_GT(most, 0.1f);
    }
}

// Blending is the judge of the depth buffer, and the other way round.
TEST(ShellsGl, D6_DepthBufferAndBlendingFindTheSameMaximum) {
  VERNIER_NEEDS_GL(device);
  for (const double a : {0.0, 0.9}) {
    ShellCase c;
    c.view = {240, 200};
    c.shells().a = a, c.shells().b = 0.2;
    c.shells().levels.clear();
    c.shells().count = 64;
    const Images depth = *c.draw("shells.gl"), blended = *c.draw("shells.glmax");
    std::size_t different = 0;
    for (std::size_t n = 0; n < depth.colour.size(); n += 4)
      different += std::abs(depth.colour[n] - blended.colour[n]) > 1e-4f;
    EXPECT_LE(different, depth.depth.size() / 1000);
  }
}

TEST(ShellsGl, D6_BlendingDoesNotCareForTheOrderOfTrianglesBitByBit) {
  VERNIER_NEEDS_GL(device);
  ShellCase c;
  c.shells().a = 0.5, c.shells().b = 0.3;
  native::ShellsJob job = c.job();
  Images sorted, shuffled;
  ASSERT_TRUE(angiography::drawGlShells(*device, job, {angiography::Maximum::Blending, {}}, sorted, {}).ok());
  for (native::Shell& s : job.shells) {
    MeshBuilder b;
    const auto vertices = s.mesh->vertices();
    const auto triangles = s.mesh->triangles();
    for (std::size_t n = triangles.size(); n-- > 0;)
      b.triangle(b.vertex(vertices[triangles[n][0]].p), b.vertex(vertices[triangles[n][1]].p),
                 b.vertex(vertices[triangles[n][2]].p));
    s.mesh = *b.finish();
  }
  std::reverse(job.shells.begin(), job.shells.end());
  ASSERT_TRUE(
      angiography::drawGlShells(*device, job, {angiography::Maximum::Blending, {}}, shuffled, {}).ok());
  EXPECT_EQ(sorted.colour, shuffled.colour);
}

TEST(ShellsGl, OddStateOfAnotherChangesNothing) {
  VERNIER_NEEDS_GL(device);
  ShellCase c;
  c.addTool(tetrahedron(8), c.sources.volumes["v"]->grid().centre());
  for (const char* technique : {"shells.gl", "shells.glmax"}) {
    const Images clean = *c.draw(technique);
    for (unsigned seed : {1u, 2u}) {
      device->setOddStateForTest(seed);
      EXPECT_EQ(c.draw(technique)->colour, clean.colour) << technique;
    }
  }
}

TEST(ShellsGl, WhatTheDepthBufferDoesNotResolveIsBlended) {
  ShellCase c;
  c.shells().levels = {0.1, 100, 200};
  c.shells().a = 1;
  EXPECT_FALSE(angiography::depthResolves(c.job()));
  c.shells().a = 0;  // by rank
  EXPECT_TRUE(angiography::depthResolves(c.job()));
  c.shells().a = 1, c.shells().levels = {1, 100, 200};
  EXPECT_TRUE(angiography::depthResolves(c.job()));
  if (!ShellHost::instance().capabilities.gl) return;
  c.shells().levels = {0.1, 100, 200};
  EXPECT_THAT(c.plan("shells.gl").error().sentence, HasSubstr("24 bits of depth"));
  EXPECT_TRUE(c.plan("shells.glmax").ok());
}

TEST(ShellsGl, MorePlanesThanItHasClipDistancesAreRefused) {
  if (!ShellHost::instance().capabilities.gl) return;
  ShellCase c;
  const PatientPoint middle = c.sources.volumes["v"]->grid().centre();
  for (int n = 0; n < 8; ++n) {
    const double u = n * std::numbers::pi / 4;
    const glm::dvec3 normal(std::cos(u), std::sin(u), 0);
    c.scene.clip.push_back({PatientVec(normal), glm::dot(normal, middle.p) + 4});
  }
  EXPECT_THAT(c.plan("shells.gl").error().sentence, HasSubstr("8 planes; GL cuts shells by up to 7"));
  EXPECT_TRUE(c.plan("shells.native").ok());
  c.scene.clip.pop_back();
  expectTruth(c, "shells.gl", 1e-3);
}

}  // namespace
}  // namespace vernier::test
