// SPDX-License-Identifier: GPL-3.0-or-later
// NUMERICS 1.4, E: translucent layers, coplanar surfaces, depth, the eye inside, slivers, opacity.
#include "SurfaceCases.h"

namespace vernier::native {
namespace {

class SurfaceLayersOfBoth : public ::testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(Both, SurfaceLayersOfBoth,
                         ::testing::Values(Projection::Orthographic, Projection::Perspective),
                         [](const auto& p) {
                           return p.param == Projection::Perspective ? "Perspective" : "Orthographic";
                         });

TEST_P(SurfaceLayersOfBoth, E1_TheOrderOfTranslucentSurfacesDoesNotMatter) {
  SurfaceJob job;
  job.camera = cameraFor(turned(30, 20, GetParam()), 128, 128);
  job.surfaces = {{soup(40, 25, 20, 11), {}, {1, 0, 0}, 0.3},
                  {soup(40, 25, 20, 12), {}, {0, 1, 0}, 0.6},
                  {soup(10, 25, 20, 13), {}, {0, 0, 1}, 1},
                  {soup(40, 25, 20, 14), {}, {1, 1, 1}, 0.1}};
  Images first, other;
  ASSERT_TRUE(drawSurfaces(job, first, {}).ok());
  std::reverse(job.surfaces.begin(), job.surfaces.end());
  std::swap(job.surfaces[0], job.surfaces[2]);
  ASSERT_TRUE(drawSurfaces(job, other, {}).ok());
  EXPECT_EQ(first.colour, other.colour);
  // And it is what the sorted list of each ray says.
  for (int row = 2; row < 128; row += 9)
    for (int column = 3; column < 128; column += 7) {
      long double margin = 1;
      glm::dvec3 colour(0);
      double through = 1;
      for (const Hit& h : allHits(job, column + 0.5, row + 0.5, &margin)) {
        const PlacedSurface& s = job.surfaces[h.surface];
        const Triangle& t = s.mesh->triangles()[h.triangle];
        const double cosine = std::abs(glm::dot(glm::normalize(s.mesh->normalTimesTwiceArea(t).v),
                                                job.camera.ray(column + 0.5, row + 0.5).direction.v));
        colour += through * s.opacity * (0.2 + 0.8 * cosine) * s.colour;
        through *= 1 - s.opacity;
      }
      if (margin < 1e-12L) continue;
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(
            other.colour[4 * static_cast<std::size_t>(column + 128 * row) + static_cast<std::size_t>(c)],
            colour[c], 1e-6);
    }
}

TEST(SurfaceLayers, E2_MoreLayersThanARayIsGivenAreJoinedAndReported) {
  SurfaceJob job;
  job.camera = cameraFor(turned(0, 0, Projection::Orthographic), 16, 16);
  for (int i = 0; i < 12; ++i) job.surfaces.push_back({square(100, i), {}, {1, 1, 1}, 0.25});
  const auto hits = findSurfaces(job, {});
  ASSERT_TRUE(hits.ok());
  EXPECT_EQ(hits->pixelsBeyond, 256u);
  const double through = std::pow(0.75, 8), rest = 1 - std::pow(0.75, 4);
  EXPECT_NEAR(hits->largestResidual, through * rest, 1e-12);
  for (std::size_t pixel = 0; pixel < 256; ++pixel) {
    ASSERT_EQ(layersAt(*hits, pixel), kSurfaceLayers + 1);
    const SurfaceHits::Layer& tail = hits->layers[hits->first[pixel] + kSurfaceLayers];
    EXPECT_NEAR(tail.alpha, rest, 1e-6);
    EXPECT_NEAR(tail.t_mm, 100 + 8, 1e-4);
  }
  // The picture of surfaces alone resolves all of them.
  Images images;
  ASSERT_TRUE(drawSurfaces(job, images, {}).ok());
  EXPECT_NEAR(images.colour[0], 1 - std::pow(0.75, 12), 1e-6);
}

TEST_P(SurfaceLayersOfBoth, E3_CoplanarSurfacesHaveOneWinnerOver100Frames) {
  SurfaceJob job;
  job.surfaces = {{square(20, 0, 3), {}, {1, 0, 0}, 1}, {square(20, 0, 5, true), {}, {0, 1, 0}, 1}};
  std::size_t seen = 0;
  for (int frame = 0; frame < 100; ++frame) {
    job.camera = cameraFor(turned(-40 + 0.8 * frame, 25 - 0.5 * frame, GetParam()), 64, 64);
    Images images;
    ASSERT_TRUE(drawSurfaces(job, images, {}).ok());
    for (std::size_t pixel = 0; pixel < 64 * 64; ++pixel) {
      ASSERT_EQ(images.colour[4 * pixel], 0.0f) << frame << " " << pixel;  // never the first one
      seen += images.colour[4 * pixel + 1] > 0;
    }
  }
  EXPECT_GT(seen, 20'000u);
  // Translucent ones lie in the same order: the later one in front.
  for (PlacedSurface& s : job.surfaces) s.opacity = 0.5;
  const auto hits = findSurfaces(job, {});
  ASSERT_TRUE(hits.ok());
  for (std::size_t pixel = 0; pixel < 64 * 64; ++pixel)
    if (layersAt(*hits, pixel) > 0) {
      ASSERT_EQ(layersAt(*hits, pixel), 2u);
      ASSERT_GT(hits->layers[hits->first[pixel]].g, 0.0f);
    }
}

TEST_P(SurfaceLayersOfBoth, E4_ATenthOfAMillimetreAtNearlyTwoMetresIsSeparated) {
  Camera camera = turned(0, 0, GetParam());
  camera.distance_mm = 1900, camera.height_mm = 100, camera.fov_deg = 3;
  SurfaceJob job;
  job.camera = cameraFor(camera, 128, 128);
  for (const bool redFirst : {true, false}) {
    job.surfaces = {{square(40, 0, 4), {}, {1, 0, 0}, 1}, {square(40, 0.1, 3, true), {}, {0, 1, 0}, 1}};
    if (!redFirst) std::swap(job.surfaces[0], job.surfaces[1]);
    Images images;
    ASSERT_TRUE(drawSurfaces(job, images, {}).ok());
    std::size_t red = 0, green = 0;
    for (std::size_t pixel = 0; pixel < 128 * 128; ++pixel) {
      red += images.colour[4 * pixel] > 0, green += images.colour[4 * pixel + 1] > 0;
    }
    EXPECT_GT(red, 5'000u);
    EXPECT_LT(green, GetParam() == Projection::Perspective ? 5u : 1u);
  }
}

TEST(SurfaceLayers, E4_ADepthBufferOf24BitsFromATenthOfAMillimetreWouldNotSeparateThem) {
  // Why no depth of that kind is used here: near 0.1, far 10,000 mm, as NUMERICS 1.1 has it.
  const auto z24 = [](double z) { return std::floor(16777215 * (1e4 / (1e4 - 0.1)) * (1 - 0.1 / z)); };
  EXPECT_EQ(z24(1900.0), z24(1900.1));
}

TEST_P(SurfaceLayersOfBoth, E5_TheEyeInsideABoxSeesItsWallsEverywhere) {
  Camera camera = turned(25, 15, GetParam());
  camera.distance_mm = 0, camera.fov_deg = 90, camera.height_mm = 20, camera.near_mm = 1;
  SurfaceJob job;
  job.camera = cameraFor(camera, 96, 96);
  job.surfaces = {{box({-30, -30, -30}, {30, 30, 30}), {}, {1, 1, 1}, 1}};
  Images images;
  ASSERT_TRUE(drawSurfaces(job, images, {}).ok());
  for (std::size_t pixel = 0; pixel < 96 * 96; ++pixel) {
    ASSERT_TRUE(std::isfinite(images.depth[pixel]));
    ASSERT_GE(images.colour[4 * pixel], 0.2f);
  }
  // A near plane beyond the walls' nearest part cuts a hole into them, and nothing is drawn in it.
  camera.near_mm = 33;
  job.camera = cameraFor(camera, 96, 96);
  ASSERT_TRUE(drawSurfaces(job, images, {}).ok());
  std::size_t open = 0;
  for (int row = 0; row < 96; ++row)
    for (int column = 0; column < 96; ++column) {
      const float depth = images.depth[static_cast<std::size_t>(column + 96 * row)];
      open += !std::isfinite(depth);
      if (std::isfinite(depth)) {
        ASSERT_GE(depth, 33 * job.camera.rayPerDepth(column + 0.5, row + 0.5) * (1 - 1e-6));
      }
    }
  EXPECT_GT(open, 100u);
  EXPECT_LT(open, 96u * 96u);
}

TEST(SurfaceLayers, E6_SliversAndTrianglesSeenEdgeOnLeaveNoHoleAndNoNaN) {
  // A sheet with needles of 1e-13 mm between its parts, and a wall that is seen exactly from its edge.
  std::vector<std::array<glm::dvec3, 3>> t = {
      {{{-50, 0, -50}, {0, 0, -50}, {0, 0, 50}}},   {{{-50, 0, -50}, {0, 0, 50}, {-50, 0, 50}}},
      {{{0, 0, -50}, {1e-13, 0, 0}, {0, 0, 50}}},   {{{0, 0, -50}, {50, 0, -50}, {1e-13, 0, 0}}},
      {{{50, 0, -50}, {50, 0, 50}, {1e-13, 0, 0}}}, {{{50, 0, 50}, {0, 0, 50}, {1e-13, 0, 0}}},
      {{{0, 0, -50}, {0, 90, -50}, {0, 90, 50}}}};
  SurfaceJob job;
  job.surfaces = {{meshOf(t), {}, {1, 1, 1}, 0.5}};
  Camera camera = turned(0, 0, Projection::Orthographic);
  camera.height_mm = 63;
  for (const int width : {63, 64}) {
    job.camera = cameraFor(camera, width, 63);
    const auto hits = findSurfaces(job, {});
    ASSERT_TRUE(hits.ok());
    for (std::size_t pixel = 0; pixel < static_cast<std::size_t>(63 * width); ++pixel) {
      ASSERT_EQ(layersAt(*hits, pixel), 1u) << pixel;
      ASSERT_TRUE(std::isfinite(hits->layers[hits->first[pixel]].r));
    }
  }
}

TEST(SurfaceLayers, E7_OpacityFromNothingToAll) {
  SurfaceJob job;
  job.background = {0.25, 0.5, 0.75};
  job.camera = cameraFor(turned(0, 0, Projection::Orthographic), 8, 8);
  const auto drawn = [&](double opacity, int n) {
    job.surfaces.clear();
    for (int i = 0; i < n; ++i) job.surfaces.push_back({square(100, i), {}, {1, 1, 1}, opacity});
    Images images;
    EXPECT_TRUE(drawSurfaces(job, images, {}).ok());
    return images;
  };
  const Images none = drawn(0, 3);
  EXPECT_EQ(none.counters.triangles, 0u);
  EXPECT_EQ(none.colour[0], 0.25f);
  EXPECT_FALSE(std::isfinite(none.depth[0]));
  EXPECT_NEAR(drawn(1.0 / 255, 1).colour[0], 0.25 + 0.75 / 255, 1e-7);
  EXPECT_NEAR(drawn(0.01, 64).colour[0], 1 - 0.75 * std::pow(0.99, 64), 1e-6);
  const Images all = drawn(1, 1), nearly = drawn(std::nextafter(1.0, 0.0), 1);
  EXPECT_EQ(all.colour, nearly.colour);
  EXPECT_TRUE(std::isfinite(all.depth[0]));
}

}  // namespace
}  // namespace vernier::native
