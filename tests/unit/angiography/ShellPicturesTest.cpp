// SPDX-License-Identifier: GPL-3.0-or-later
// What shells look like, pixel by pixel, without tools and cuts.
#include <algorithm>

#include "ShellCases.h"
#include "vernier/base/Threads.h"

namespace vernier::test {
namespace {

class ShellPictures : public ::testing::TestWithParam<const char*> {
 protected:
  std::string technique() const { return GetParam(); }
  bool native() const { return technique() == "shells.native"; }
  // Floats of GL: brightness is computed in the fragment.
  double tolerance() const { return native() ? 1e-6 : 2e-4; }
};
#define NEEDS_GL_UNLESS_NATIVE \
  if (!native() && !glDevice()) return

TEST_P(ShellPictures, D1_EveryPixelIsThatOfItsRaysCrossings) {
  NEEDS_GL_UNLESS_NATIVE;
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum, ShellsMode::Lit})
      for (const double a : {0.0, 0.8}) {
        if (a > 0 && mode == ShellsMode::Lit) continue;
        ShellCase c(vesselVolume(a > 0));
        c.scene.camera.projection = projection;
        c.scene.background = {0.05, 0, 0.1};
        c.shells().mode = mode;
        c.shells().a = a, c.shells().b = 0.3, c.shells().beta0 = 0.1, c.shells().phi0 = 0.2;
        c.shells().colour = {1, 0.9, 0.5};
        SCOPED_TRACE(c.plan(technique())->passes[0].params->dump());
        expectTruth(c, technique(),
                    mode == ShellsMode::Sum               ? 5 * tolerance()
                    : mode == ShellsMode::Lit && native() ? 1e-4
                                                          : tolerance());
      }
}

TEST_P(ShellPictures, TheEyeMayStandInsideTheShells) {
  NEEDS_GL_UNLESS_NATIVE;
  for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum})
    for (const double distance_mm : {0.5, 5.0}) {
      ShellCase c;
      c.scene.camera.projection = Projection::Perspective;
      c.scene.camera.fov_deg = 90, c.scene.camera.distance_mm = distance_mm, c.scene.camera.zoom = 1;
      c.scene.camera.near_mm = 0.2;
      c.shells().mode = mode;
      c.shells().a = 0.5, c.shells().b = 0.4;
      expectTruth(c, technique(), 10 * tolerance());
    }
}

TEST_P(ShellPictures, CueByDistanceIsEvenInPerspective) {
  NEEDS_GL_UNLESS_NATIVE;
  ShellCase c;
  c.scene.camera.projection = Projection::Perspective;
  c.scene.camera.distance_mm = 25;
  c.shells().a = 1, c.shells().b = 0.1;
  const Result<Images> projected = c.draw(technique());
  c.shells().cueByDistance = true;
  expectTruth(c, technique(), tolerance());
  EXPECT_NE(projected->colour, c.draw(technique())->colour);
}

// The brightness of no cue, whatever road leads to it.
TEST_P(ShellPictures, ACueOfNothingIsNoCueBitByBit) {
  NEEDS_GL_UNLESS_NATIVE;
  ShellCase c;
  c.shells().beta0 = 0.1;
  const Images plain = *c.draw(technique());
  c.shells().a = 1e-300;
  EXPECT_EQ(c.draw(technique())->colour, plain.colour);
  c.shells().a = 0, c.shells().cueByDistance = true;
  EXPECT_EQ(c.draw(technique())->colour, plain.colour);
}

TEST_P(ShellPictures, D6_ViewsFromBothSidesMirrorEachOther) {
  NEEDS_GL_UNLESS_NATIVE;
  ShellCase c;
  c.scene.camera.roll_deg = 0;
  const Images front = *c.draw(technique());
  c.scene.camera.azimuth_deg += 180, c.scene.camera.elevation_deg *= -1;
  const Images back = *c.draw(technique());
  int different = 0, edges = 0;
  const auto grey = [](const Images& i, int x, int y) {
    return i.colour[static_cast<std::size_t>(4 * (x + i.width * y))];
  };
  for (int y = 1; y + 1 < front.height; ++y)
    for (int x = 1; x + 1 < front.width; ++x) {
      // No cue: the highest shell that a line meets does not depend on the side that one looks from.
      const float here = grey(front, x, y);
      bool edge = false;
      for (int n = 0; n < 9; ++n) edge = edge || grey(front, x + n % 3 - 1, y + n / 3 - 1) != here;
      edges += edge;
      different += !edge && grey(back, front.width - 1 - x, y) != here;
    }
  EXPECT_EQ(different, 0);
  EXPECT_GT(edges, 50);
}

TEST_P(ShellPictures, D4_NegativeValuesAndNothingToShow) {
  NEEDS_GL_UNLESS_NATIVE;
  VolumeInfo info;
  info.grid = unitGrid(8, 8, 8);
  ShellCase c(volumeOf(info, randomValues<std::int16_t>(512, 3, -1000, -500)));
  c.shells().levels = {-100, 0};
  c.shells().window.reset();
  const Images none = *c.draw(technique());
  for (std::size_t n = 0; n < none.depth.size(); ++n) {
    EXPECT_EQ(none.depth[n], kNothing_mm);
    for (std::size_t ch = 0; ch < 3; ++ch) EXPECT_EQ(none.colour[4 * n + ch], 0.0f);
    EXPECT_EQ(none.colour[4 * n + 3], 1.0f);
  }
  c.shells().levels.clear();
  c.shells().count = 3;
  c.shells().window.reset();
  expectTruth(c, technique(), tolerance());
}

TEST_P(ShellPictures, DisabledLevelsAreNeitherMadeNorDrawn) {
  NEEDS_GL_UNLESS_NATIVE;
  ShellCase c;
  const auto& store = *ShellHost::instance().store;
  c.shells().disabled = {1, 3};
  const std::uint64_t before = store.extracted;
  const Images some = *c.draw(technique());
  EXPECT_EQ(store.extracted - before, 3u);
  c.shells().beta0 = 0.3, c.shells().a = 0.2, c.shells().b = 0.7;
  ASSERT_TRUE(c.draw(technique()).ok());
  EXPECT_EQ(store.extracted - before, 3u);  // brightness is none of the geometry's business
  expectTruth(c, technique(), tolerance());
  c.shells().disabled = {3};
  const Images more = *c.draw(technique());
  EXPECT_EQ(store.extracted - before, 4u);
  EXPECT_GT(more.counters.triangles, some.counters.triangles);
  c.shells().disabled = {0, 1, 2, 3, 4};
  EXPECT_EQ(c.draw(technique())->counters.triangles, 0u);
}

// The silhouette of the darkest shell is that of the plain surface, as the paper's transformation after the
// projection promises.
TEST_P(ShellPictures, PerspectiveKeepsSilhouettes) {
  NEEDS_GL_UNLESS_NATIVE;
  ShellCase c;
  c.scene.camera.projection = Projection::Perspective;
  c.scene.camera.distance_mm = 30;
  c.shells().a = 0.7, c.shells().b = 0.2;
  const Images images = *c.draw(technique());
  native::SurfaceJob plain;
  plain.camera = c.job().camera;
  plain.surfaces = {{c.job().shells[0].mesh, {}, glm::dvec3(1), 1}};
  Images surface;
  ASSERT_TRUE(native::drawSurfaces(plain, surface, {}).ok());
  const auto inside = [&](int x, int y) {
    return surface.depth[static_cast<std::size_t>(x + surface.width * y)] < kNothing_mm;
  };
  int off = 0;
  for (int y = 1; y + 1 < images.height; ++y)
    for (int x = 1; x + 1 < images.width; ++x) {
      const bool shown = images.depth[static_cast<std::size_t>(x + images.width * y)] < kNothing_mm;
      bool near = false;
      for (int n = 0; n < 9; ++n) near = near || inside(x + n % 3 - 1, y + n / 3 - 1) == shown;
      off += !near;
    }
  EXPECT_EQ(off, 0);
}

TEST_P(ShellPictures, CancelledWithASentence) {
  NEEDS_GL_UNLESS_NATIVE;
  ShellCase c;
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(c.draw(technique(), stop.get_token()).error().code, ErrorCode::Cancelled);
}

INSTANTIATE_TEST_SUITE_P(All, ShellPictures, ::testing::ValuesIn(kShellTechniques), shellTechniqueName);

TEST(ShellsNative, TheSameBitsForAnyNumberOfThreads) {
  ShellCase c;
  c.view = {200, 150};
  c.shells().mode = ShellsMode::Sum;
  setThreads(1);
  const Images one = *c.draw();
  setThreads(0);
  EXPECT_EQ(c.draw()->colour, one.colour);
}

TEST(ShellsNative, ShuffledShellsGiveTheSameMaximumAndSum) {
  ShellCase c;
  c.shells().a = 0.5;
  for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum}) {
    c.shells().mode = mode;
    native::ShellsJob job = c.job();
    Images sorted, shuffled;
    ASSERT_TRUE(native::drawShells(job, sorted, {}).ok());
    std::swap(job.shells[0], job.shells[3]);
    std::swap(job.shells[1], job.shells[2]);
    ASSERT_TRUE(native::drawShells(job, shuffled, {}).ok());
    for (std::size_t n = 0; n < sorted.colour.size(); ++n)
      if (mode == ShellsMode::Max)
        ASSERT_EQ(sorted.colour[n], shuffled.colour[n]);
      else
        ASSERT_NEAR(sorted.colour[n], shuffled.colour[n], 1e-5);
  }
}

}  // namespace
}  // namespace vernier::test
