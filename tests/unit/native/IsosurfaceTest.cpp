// SPDX-License-Identifier: GPL-3.0-or-later
// Iso-surfaces: the place that is found lies on the level and nothing before it reaches the level; faces of
// cuts; tools; grids with holes.
#include "vernier/native/Isosurface.h"

#include <gtest/gtest.h>

#include "VolumeCases.h"
#include "vernier/base/Threads.h"

namespace vernier {
namespace {

using native::IsosurfaceJob;
using test::BruteCaster;

struct IsoCase {
  std::shared_ptr<const Volume> volume;
  std::shared_ptr<const native::ProjectionBounds> bounds;
  std::shared_ptr<const native::VisibleBricks> reaching;
  IsosurfaceJob job;
  Images draw() const {
    Images images;
    const Result<void> drawn = native::drawIsosurface(job, images);
    EXPECT_TRUE(drawn.ok()) << (drawn.ok() ? "" : drawn.error().text());
    return images;
  }
  void useBricks() {
    bounds = *native::projectionBounds(*volume);
    reaching = native::bricksReaching(*bounds, job.level);
    job.reaching = reaching.get();
  }
};

IsoCase isoCase(std::shared_ptr<const Volume> volume, double level, Camera camera = test::turnedCamera(),
                const Scene& scene = {}, View view = {120, 110}) {
  IsoCase c;
  c.volume = std::move(volume);
  const GridGeometry& grid = c.volume->grid();
  c.job.volume = c.volume.get();
  c.job.level = level;
  c.job.camera = *cameraPicture(camera, view, cameraBox(grid));
  c.job.region = *keptRegion(scene, grid);
  c.job.background = scene.background;
  c.job.material = IsosurfaceLayer{}.material;
  c.job.step_mm = 0.8;
  return c;
}

native::VolumeRenderJob volumeJob(const IsoCase& c) {
  native::VolumeRenderJob job;
  job.volume = c.volume.get(), job.camera = c.job.camera;
  return job;
}

// Checks what a picture of a noisy field says, ray by ray; returns how many rays meet the surface.
int expectFirstReached(const IsoCase& c, const Images& images) {
  const native::VolumeRenderJob job = volumeJob(c);
  const BruteCaster brute(job);
  const auto value = [&](const PatientRay& ray, double t) {
    return brute.field((c.volume->voxelFromPatient() * ray.at(t)).p);
  };
  int found = 0;
  for (int n = 0; n < 1000; ++n) {
    const int x = int(randomUnit(3, std::uint64_t(2 * n)) * images.width);
    const int y = int(randomUnit(3, std::uint64_t(2 * n + 1)) * images.height);
    const PatientRay ray = c.job.camera.ray(x + 0.5, y + 0.5);
    const RaySpan span =
        spanOf(ray, c.job.region, c.job.camera.near_mm * c.job.camera.rayPerDepth(x + 0.5, y + 0.5));
    const double t = double(images.depth[std::size_t(x + images.width * y)]);
    const double until = std::isinf(t) ? span.exit_mm : t - 1e-4;
    if (!span.empty() && std::isfinite(t)) {
      ++found;
      if (t > span.entry_mm + 1e-4)
        EXPECT_NEAR(value(ray, t), c.job.level, 0.1) << x << " " << y;
      else
        EXPECT_GE(value(ray, t + 1e-4), c.job.level - 0.1);
    }
    for (double s = span.entry_mm; !span.empty() && s < until; s += 0.05)
      EXPECT_LT(value(ray, s), c.job.level + 0.1) << x << " " << y << " at " << s << " of " << t;
  }
  return found;
}

template <class T>
std::shared_ptr<const Volume> noise(double slope = 1) {
  VolumeInfo info = test::obliqueVolume(27, 23, 19);
  info.rescale = {ModalityRescale{slope, 20}};
  return test::volumeOf(info, test::randomValues<T>(27 * 23 * 19, 11, 0, 100));
}

TEST(Isosurface, FirstPlaceOnTheLevel) {
  for (const Projection p : {Projection::Orthographic, Projection::Perspective}) {
    EXPECT_GT(expectFirstReached(isoCase(noise<std::int16_t>(), 105, test::turnedCamera(p)),
                                 isoCase(noise<std::int16_t>(), 105, test::turnedCamera(p)).draw()),
              30);
    const IsoCase falling = isoCase(noise<float>(-1), 5, test::turnedCamera(p));
    EXPECT_GT(expectFirstReached(falling, falling.draw()), 30);
    const IsoCase byte = isoCase(noise<std::uint8_t>(), 108, test::turnedCamera(p));
    EXPECT_GT(expectFirstReached(byte, byte.draw()), 20);
  }
}

// A plate of one voxel in thickness, and steps that are longer than it.
TEST(Isosurface, NoStepMatters) {
  const VolumeInfo info = test::obliqueVolume(30, 30, 30);
  std::vector<std::int16_t> v(30 * 30 * 30, 0);
  for (int n = 0; n < 900; ++n) v[std::size_t(900 * 15 + n)] = 100;
  IsoCase c = isoCase(test::volumeOf(info, v), 99.9);
  const Images fine = c.draw();
  c.job.step_mm = 7;
  c.useBricks();
  const Images coarse = c.draw();
  EXPECT_EQ(fine.colour, coarse.colour);
  EXPECT_GT(std::count_if(fine.depth.begin(), fine.depth.end(), [](float d) { return std::isfinite(d); }),
            60);
}

TEST(Isosurface, WhatIsLeftOutChangesNoBit) {
  for (const Projection p : {Projection::Orthographic, Projection::Perspective})
    for (const double level : {60.0, 105.0, 118.0}) {
      IsoCase c = isoCase(noise<std::int16_t>(), level, test::turnedCamera(p), {}, {90, 70});
      const Images all = c.draw();
      c.useBricks();
      const Images some = c.draw();
      EXPECT_EQ(all.colour, some.colour);
      EXPECT_EQ(all.depth, some.depth);
      EXPECT_LE(some.counters.cells, all.counters.cells);
    }
}

TEST(Isosurface, BitEqualForAnyThreads) {
  const int before = threads();
  IsoCase c = isoCase(noise<std::int16_t>(), 105);
  c.useBricks();
  std::vector<float> first;
  for (const int n : {1, 2, 3}) {
    setThreads(n);
    const Images images = c.draw();
    if (first.empty()) first = images.colour;
    EXPECT_EQ(first, images.colour);
  }
  setThreads(before);
}

// A sphere has its normals along its radii.
TEST(Isosurface, ASphereIsLitByItsNormals) {
  VolumeInfo info;
  info.grid = test::unitGrid(41, 41, 41);
  std::vector<float> v;
  for (int k = 0; k < 41; ++k)
    for (int j = 0; j < 41; ++j)
      for (int i = 0; i < 41; ++i) v.push_back(float(-std::hypot(i - 20.0, j - 20.0, k - 20.0)));
  Camera camera;
  camera.azimuth_deg = 20, camera.elevation_deg = 30;
  IsoCase c = isoCase(test::volumeOf(info, v), -12, camera, {}, {64, 56});
  c.job.lights = {Light{PatientVec(1, -2, 1), {1, .8, .6}}, Light{std::nullopt, {.1, .2, .3}}};
  c.job.material = {0.1, 0.6, 0.4, 11, {.9, .8, .7}, {.5, .6, .7}};
  const Images images = c.draw();
  int hits = 0;
  double worst = 0;
  for (int y = 0; y < images.height; ++y)
    for (int x = 0; x < images.width; ++x) {
      const std::size_t pixel = std::size_t(x + images.width * y);
      const PatientRay ray = c.job.camera.ray(x + 0.5, y + 0.5);
      const glm::dvec3 o = ray.origin.p - c.volume->grid().centre().p, d = ray.direction.v;
      const double b = glm::dot(o, d), disc = b * b - glm::dot(o, o) + 144;
      if (disc < 20) continue;  // silhouettes: the trilinear field is no sphere
      ++hits;
      const double t = -b - std::sqrt(disc);
      EXPECT_NEAR(double(images.depth[pixel]), t, 0.05);
      const glm::dvec3 n = glm::normalize(o + t * d), eye = -d, l = glm::normalize(glm::dvec3(1, -2, 1));
      const auto part = [&](const glm::dvec3& to, const glm::dvec3& light) {
        const double nh = std::max(0.0, glm::dot(n, glm::normalize(to + eye)));
        return light *
               (0.6 * std::max(0.0, glm::dot(n, to)) * glm::dvec3(.5, .6, .7) + 0.4 * std::pow(nh, 11));
      };
      const glm::dvec3 truth =
          glm::clamp(0.1 * glm::dvec3(.9, .8, .7) + part(l, {1, .8, .6}) + part(eye, {.1, .2, .3}), 0.0, 1.0);
      for (int k = 0; k < 3; ++k)
        worst = std::max(worst, std::abs(truth[k] - double(images.colour[4 * pixel + std::size_t(k)])));
    }
  EXPECT_GT(hits, 200);
  EXPECT_LT(worst, 0.02);
}

TEST(Isosurface, CutsShowFacesTurnedToTheEye) {
  VolumeInfo info;
  info.grid = test::unitGrid(20, 20, 20);
  const auto volume = test::volumeOf(info, std::vector<std::int16_t>(8000, 100));
  Scene scene;
  scene.clip = {HalfSpace{normalize(PatientVec(1, -1, 0.3)),
                          glm::dot(glm::normalize(glm::dvec3(1, -1, 0.3)), volume->grid().centre().p)}};
  scene.background = {.1, .2, .3};
  IsoCase c = isoCase(volume, 50, test::turnedCamera(), scene);
  c.useBricks();
  const Images images = c.draw();
  const Material& m = c.job.material;
  const double share = m.ambient + m.diffuse;
  int inside = 0;
  for (int y = 0; y < images.height; ++y)
    for (int x = 0; x < images.width; ++x) {
      const std::size_t pixel = std::size_t(x + images.width * y);
      const RaySpan span = spanOf(c.job.camera.ray(x + 0.5, y + 0.5), c.job.region, 0);
      if (span.empty() || span.exit_mm - span.entry_mm < 1e-6) continue;
      ++inside;
      EXPECT_NEAR(images.depth[pixel], span.entry_mm, 1e-4);
      EXPECT_NEAR(images.colour[4 * pixel], std::min(1.0, share * m.diffuseColour.r + m.specular), 1e-6);
      EXPECT_NEAR(images.colour[4 * pixel + 2], std::min(1.0, share * m.diffuseColour.b + m.specular), 1e-6);
    }
  EXPECT_GT(inside, 500);
}

TEST(Isosurface, ToolsStandBeforeAndBehind) {
  VolumeInfo info;
  info.grid = test::unitGrid(20, 20, 20);
  Camera camera;
  camera.height_mm = 1;
  IsoCase c = isoCase(test::volumeOf(info, std::vector<std::int16_t>(8000, 100)), 50, camera, {}, {2, 1});
  const Images bare = c.draw();
  const float face = bare.depth[0];
  ASSERT_TRUE(std::isfinite(face));
  native::SurfaceHits tools;
  tools.width = 2, tools.height = 1;
  tools.end_mm = {kNothing_mm, face - 1};
  tools.endColour = {0, 0, 0, .2f, .4f, .6f};
  tools.first = {0, 2, 3};
  tools.layers = {{face - 2, .25f, 0, 0, .5f}, {face + 1, 0, .5f, 0, .5f}, {face - 3, 0, 0, .125f, .25f}};
  c.job.tools = &tools;
  const Images images = c.draw();
  EXPECT_NEAR(images.colour[0], .25 + .5 * bare.colour[0], 1e-6);  // the layer behind takes no part
  EXPECT_NEAR(images.colour[1], .5 * bare.colour[1], 1e-6);
  EXPECT_EQ(images.depth[0], face);
  EXPECT_NEAR(images.colour[4], .75 * .2, 1e-6);
  EXPECT_NEAR(images.colour[6], .125 + .75 * .6, 1e-6);
  EXPECT_EQ(images.depth[1], face - 1);
}

TEST(Isosurface, HolesAreNeitherInsideNorOutside) {
  VolumeInfo info;
  info.grid = test::unitGrid(20, 20, 20);
  info.noData = NoDataRange{-1, -1};
  std::vector<std::int16_t> v(8000, 100);
  for (int n = 0; n < 8000; ++n)
    if (n / 400 >= 12) v[std::size_t(n)] = -1;  // the upper slices
  Camera camera;
  camera.elevation_deg = 90;
  IsoCase c = isoCase(test::volumeOf(info, v), 50, camera);
  c.job.step_mm = 0.25;
  EXPECT_FALSE(native::findsExactly(c.job));
  c.useBricks();
  const Images images = c.draw();
  const std::size_t middle = std::size_t(images.width / 2 + images.width * (images.height / 2));
  // From above: the first data stand at slice 12, up to which voxels of slice 11 are renormalised.
  const double top = images.depth[middle];
  const double face = glm::length(c.job.camera.eye.p - c.volume->grid().centre().p) - (12 - 9.5);
  EXPECT_NEAR(top, face, 0.26);
  IsoCase high = isoCase(c.volume, 1000, camera);
  EXPECT_TRUE(std::isinf(high.draw().depth[middle]));
}

TEST(Isosurface, RefusesAndStops) {
  IsoCase c = isoCase(noise<std::int16_t>(), 105);
  Images images;
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(native::drawIsosurface(c.job, images, stop.get_token()).error().code, ErrorCode::Cancelled);
  c.job.volume = nullptr;
  EXPECT_EQ(native::drawIsosurface(c.job, images).error().code, ErrorCode::Internal);
}

}  // namespace
}  // namespace vernier
