// SPDX-License-Identifier: GPL-3.0-or-later
// The rasteriser against rays (SurfaceCases.h), its edges, threads, instruction sets, shade and distance.
#include "SurfaceCases.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Units.h"
#include "vernier/native/Simd.h"

namespace vernier::native {
namespace {

class Rays : public ::testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(Both, Rays, ::testing::Values(Projection::Orthographic, Projection::Perspective),
                         [](const auto& p) {
                           return p.param == Projection::Perspective ? "Perspective" : "Orthographic";
                         });

// 102,400 rays: which layers, where, and where the ray ends.
TEST_P(Rays, EveryPixelAgreesWithRayTriangleTestsInLongDouble) {
  SurfaceJob job;
  job.camera = cameraFor(turned(33, 21, GetParam(), 12), 320, 320);
  PatientFromMesh pose;
  pose.linear = glm::dmat3({0.9, 0.1, 0}, {-0.2, 1.1, 0.3}, {0.1, 0, 0.8});
  pose.translation = {3, -2, 5};
  job.surfaces = {{soup(140, 30, 14, 1), pose, {1, 0, 0}, 0.5}, {soup(40, 30, 12, 2), {}, {0, 1, 0}, 1}};
  const auto hits = findSurfaces(job, {});
  ASSERT_TRUE(hits.ok());
  EXPECT_EQ(hits->counters.triangles, 180u);
  std::size_t compared = 0, met = 0;
  for (int row = 0; row < 320; ++row)
    for (int column = 0; column < 320; ++column) {
      const std::size_t pixel = static_cast<std::size_t>(column + 320 * row);
      long double margin = 1;
      const std::vector<Hit> truth = allHits(job, column + 0.5, row + 0.5, &margin);
      if (margin < 1e-12L) continue;  // the ray passes within rounding of an edge
      ++compared;
      std::size_t n = 0;
      while (n < truth.size() && truth[n].surface == 0) ++n;
      const bool ends = n < truth.size();
      ASSERT_EQ(std::isfinite(hits->end_mm[pixel]), ends) << column << " " << row;
      if (ends) {
        ASSERT_NEAR(hits->end_mm[pixel], truth[n].t_mm, 1e-7 * truth[n].t_mm);
      }
      ASSERT_EQ(layersAt(*hits, pixel), std::min(n, kSurfaceLayers + 1)) << column << " " << row;
      for (std::size_t i = 0; i < std::min(n, kSurfaceLayers); ++i)
        ASSERT_NEAR(hits->layers[hits->first[pixel] + i].t_mm, truth[i].t_mm, 1e-7 * truth[i].t_mm);
      met += n + ends;
    }
  EXPECT_GT(compared, 102'000u);
  EXPECT_GT(met, 50'000u);
}

// The eye among the triangles: many cross its plane, some lie behind it.
TEST(Surfaces, TheEyeInsideTheSoupSeesWhatRaysSee) {
  Camera camera = turned(10, -35, Projection::Perspective);
  camera.fov_deg = 100, camera.distance_mm = 0, camera.near_mm = 2;
  SurfaceJob job;
  job.camera = cameraFor(camera, 160, 120);
  job.surfaces = {{soup(300, 20, 15, 7), {}, {1, 1, 1}, 1}};
  const auto hits = findSurfaces(job, {});
  ASSERT_TRUE(hits.ok());
  std::size_t met = 0;
  for (int row = 0; row < 120; ++row)
    for (int column = 0; column < 160; ++column) {
      long double margin = 1;
      const std::vector<Hit> truth = allHits(job, column + 0.5, row + 0.5, &margin);
      if (margin < 1e-12L) continue;
      const float end = hits->end_mm[static_cast<std::size_t>(column + 160 * row)];
      ASSERT_EQ(std::isfinite(end), !truth.empty()) << column << " " << row;
      if (!truth.empty()) {
        ASSERT_NEAR(end, truth[0].t_mm, 1e-7 * truth[0].t_mm);
      }
      met += !truth.empty();
    }
  EXPECT_GT(met, 15'000u);
}

// A sheet that covers the whole picture, cut so that edges and corners pass exactly through pixel centres, or
// anywhere: every pixel is hit once, no more and no less.
TEST_P(Rays, SharedEdgesAreHitExactlyOnce) {
  for (const int n : {1, 7, 16, 64, 100})
    for (const bool other : {false, true})
      for (const double roll : {0.0, 45.0, 17.3}) {
        Camera camera = turned(0, 0, GetParam(), roll);
        camera.height_mm = 64;
        camera.distance_mm = 200;
        camera.fov_deg = 2 * Degrees(Radians(std::atan(32.0 / 200))).deg;
        SurfaceJob job;
        job.camera = cameraFor(camera, 64, 64);
        job.surfaces = {{square(50 + (n == 100 ? 0.5 : 14), 0, n, other), {}, {1, 1, 1}, 0.5}};
        const auto hits = findSurfaces(job, {});
        ASSERT_TRUE(hits.ok());
        for (std::size_t pixel = 0; pixel < 64 * 64; ++pixel)
          ASSERT_EQ(layersAt(*hits, pixel), 1u) << "n " << n << " roll " << roll << " pixel " << pixel;
      }
}

// Of a closed surface every ray meets as many fronts as backs, at its outline too.
TEST_P(Rays, ClosedSurfacesAreHitAnEvenNumberOfTimes) {
  MeshBuilder b;
  const auto at = [&](int i, int j) {
    const double u = 2 * std::numbers::pi * (i % 90) / 90, v = 2 * std::numbers::pi * (j % 40) / 40;
    return b.vertex(
        {(30 + 10 * std::cos(v)) * std::cos(u), (30 + 10 * std::cos(v)) * std::sin(u), 10 * std::sin(v)});
  };
  for (int i = 0; i < 90; ++i)
    for (int j = 0; j < 40; ++j) {
      b.triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      b.triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  SurfaceJob job;
  job.surfaces = {{*b.finish(), {}, {1, 1, 1}, 0.5}};
  std::size_t met = 0;
  for (const double azimuth : {0.0, 30.0, 90.0})
    for (const double elevation : {0.0, 20.0, 90.0}) {
      job.camera = cameraFor(turned(azimuth, elevation, GetParam()), 200, 200);
      const auto hits = findSurfaces(job, {});
      ASSERT_TRUE(hits.ok());
      for (std::size_t pixel = 0; pixel < 200 * 200; ++pixel) {
        ASSERT_EQ(layersAt(*hits, pixel) % 2, 0u) << azimuth << " " << elevation << " " << pixel;
        met += layersAt(*hits, pixel) > 0;
      }
    }
  EXPECT_GT(met, 50'000u);
}

TEST_P(Rays, TheSameBitsForAnyNumberOfThreads) {
  SurfaceJob job;
  job.camera = cameraFor(turned(30, 20, GetParam()), 300, 200);
  job.surfaces = {{soup(20'000, 40, 3, 3), {}, {1, 0.5, 0.2}, 0.3},
                  {soup(2'000, 40, 3, 4), {}, {0, 0.5, 0.2}, 1}};
  Images first;
  for (const int n : {1, 2, 7}) {
    setThreads(n);
    Images images;
    ASSERT_TRUE(drawSurfaces(job, images, {}).ok());
    EXPECT_EQ(images.counters.triangles, 22'000u);
    if (n == 1) {
      first = images;
      continue;
    }
    EXPECT_EQ(images.colour, first.colour);
    EXPECT_EQ(images.depth, first.depth);
  }
  setThreads(0);
}

TEST_P(Rays, TheSameBitsForEveryInstructionSet) {
  SurfaceJob job;
  job.camera = cameraFor(turned(30, 20, GetParam()), 300, 200);
  job.surfaces = {{soup(5'000, 40, 6, 3), {}, {1, 0.5, 0.2}, 0.3},
                  {soup(500, 40, 6, 4), {}, {0, 0.5, 0.2}, 1}};
  Images first;
  for (const std::string& target : simdTargets()) {
    ASSERT_TRUE(useSimdTarget(target));
    Images images;
    ASSERT_TRUE(drawSurfaces(job, images, {}).ok());
    if (first.width == 0) first = images;
    EXPECT_EQ(images.colour, first.colour) << target;
    EXPECT_EQ(images.depth, first.depth) << target;
  }
  useSimdTarget("");
}

// One square in front of the camera: the shade of a headlight and the distance have closed forms.
TEST(Surfaces, ShadeAndDistanceHaveClosedForms) {
  SurfaceJob job;
  job.background = {0.1, 0.2, 0.3};
  job.surfaces = {{square(10, 4), {}, {0.5, 1, 0}, 1}};
  job.camera = cameraFor(turned(0, 0, Projection::Perspective), 101, 101);
  Images images;
  ASSERT_TRUE(drawSurfaces(job, images, {}).ok());
  const double eye = 50 / std::sin(std::numbers::pi / 12), step = 2 * std::tan(std::numbers::pi / 12) / 101;
  for (int column = 0; column < 101; ++column) {
    const std::size_t pixel = static_cast<std::size_t>(column + 101 * 50);
    const double slope = (column - 50) * step, ray = std::sqrt(1 + slope * slope);
    const bool inside = std::abs(slope) * (eye + 4) <= 10;
    ASSERT_EQ(std::isfinite(images.depth[pixel]), inside) << column;
    if (!inside) {
      EXPECT_EQ(images.colour[4 * pixel + 2], 0.3f);
      continue;
    }
    EXPECT_NEAR(images.depth[pixel], (eye + 4) * ray, 2e-5);
    EXPECT_NEAR(images.colour[4 * pixel], 0.5 * (0.2 + 0.8 / ray), 1e-7);
    EXPECT_NEAR(images.colour[4 * pixel + 1], 0.2 + 0.8 / ray, 1e-7);
    EXPECT_EQ(images.colour[4 * pixel + 3], 1.0f);
  }
}

TEST(Surfaces, ACancelledPictureSaysSo) {
  std::stop_source stop;
  stop.request_stop();
  SurfaceJob job;
  job.camera = cameraFor(turned(0, 0, Projection::Orthographic), 64, 64);
  job.surfaces = {{square(10, 0), {}, {1, 1, 1}, 1}};
  Images images;
  EXPECT_EQ(drawSurfaces(job, images, stop.get_token()).error().code, ErrorCode::Cancelled);
  EXPECT_EQ(findSurfaces(job, stop.get_token()).error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace vernier::native
