// SPDX-License-Identifier: GPL-3.0-or-later
// The rasteriser against rays: every pixel of a picture is one ray, answered by Moller and Trumbore's test in
// long double over all triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "vernier/base/Random.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Units.h"
#include "vernier/native/Simd.h"
#include "vernier/native/Surfaces.h"

namespace vernier::native {
namespace {

using V = glm::vec<3, long double>;

struct Hit {
  double t_mm;
  std::size_t surface, triangle;
};

// Where a ray meets a triangle; nothing when it does not, or behind its origin. `margin` takes the smallest
// barycentric coordinate in size: near 0, rounding may decide.
std::optional<double> meet(const PatientRay& ray, const V& a, const V& b, const V& c, long double* margin) {
  const V d(ray.direction.v), o(ray.origin.p), e1 = b - a, e2 = c - a, p = glm::cross(d, e2);
  const long double det = glm::dot(e1, p);
  if (det == 0) return std::nullopt;
  const V s = o - a, q = glm::cross(s, e1);
  const long double u = glm::dot(s, p) / det, v = glm::dot(d, q) / det, t = glm::dot(e2, q) / det;
  *margin = std::min({*margin, std::abs(u), std::abs(v), std::abs(1 - u - v)});
  if (u < 0 || v < 0 || u + v > 1 || t < 0) return std::nullopt;
  return static_cast<double>(t);
}

std::vector<Hit> allHits(const SurfaceJob& job, double x, double y, long double* margin) {
  std::vector<Hit> hits;
  const PatientRay ray = job.camera.ray(x, y);
  const double nearest = job.camera.near_mm * job.camera.rayPerDepth(x, y);
  for (std::size_t s = 0; s < job.surfaces.size(); ++s) {
    const Mesh& mesh = *job.surfaces[s].mesh;
    const auto at = [&](std::uint32_t v) { return V((job.surfaces[s].pose * mesh.vertices()[v]).p); };
    for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
      const Triangle& t = mesh.triangles()[i];
      if (const auto d = meet(ray, at(t[0]), at(t[1]), at(t[2]), margin); d && *d >= nearest)
        hits.push_back({*d, s, i});
    }
  }
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.t_mm < b.t_mm; });
  return hits;
}

std::shared_ptr<const Mesh> meshOf(const std::vector<std::array<glm::dvec3, 3>>& triangles) {
  MeshBuilder b;
  for (const auto& t : triangles) {
    const std::uint32_t p = b.vertex(t[0]), q = b.vertex(t[1]);
    b.triangle(p, q, b.vertex(t[2]));
  }
  return *b.finish();
}

std::shared_ptr<const Mesh> box(glm::dvec3 low, glm::dvec3 high) {
  std::vector<std::array<glm::dvec3, 3>> t;
  const auto at = [&](int n) {
    return glm::dvec3(n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z);
  };
  constexpr int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                               {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads)
    t.push_back({at(q[0]), at(q[1]), at(q[2])}), t.push_back({at(q[0]), at(q[2]), at(q[3])});
  return meshOf(t);
}

// A square facing the camera of azimuth 0 and elevation 0 (which looks along +y), cut in n x n x 2 triangles.
std::shared_ptr<const Mesh> square(double half, double y, int n = 1, bool otherDiagonal = false) {
  std::vector<std::array<glm::dvec3, 3>> t;
  const auto at = [&](int i, int k) {
    return glm::dvec3(half * (2.0 * i / n - 1), y, half * (2.0 * k / n - 1));
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      const glm::dvec3 a = at(i, k), b = at(i + 1, k), c = at(i + 1, k + 1), d = at(i, k + 1);
      if (otherDiagonal)
        t.push_back({a, b, d}), t.push_back({b, c, d});
      else
        t.push_back({a, b, c}), t.push_back({a, c, d});
    }
  return meshOf(t);
}

std::shared_ptr<const Mesh> soup(int n, double reach, double size, std::uint64_t seed) {
  std::vector<std::array<glm::dvec3, 3>> t(static_cast<std::size_t>(n));
  std::uint64_t draw = 0;
  const auto r = [&](double s) { return s * (2 * randomUnit(seed, draw++) - 1); };
  for (auto& corners : t) {
    const glm::dvec3 middle(r(reach), r(reach), r(reach));
    for (glm::dvec3& c : corners) c = middle + glm::dvec3(r(size), r(size), r(size));
  }
  return meshOf(t);
}

CameraPicture cameraFor(const Camera& camera, int width, int height, double diagonal_mm = 100) {
  const auto picture =
      cameraPicture(camera, View{width, height}, CameraBox{PatientPoint(0, 0, 0), diagonal_mm});
  EXPECT_TRUE(picture.ok());
  return *picture;
}

Camera turned(double azimuth_deg, double elevation_deg, Projection projection, double roll_deg = 0) {
  Camera c;
  c.azimuth_deg = azimuth_deg, c.elevation_deg = elevation_deg, c.projection = projection,
  c.roll_deg = roll_deg;
  return c;
}

std::size_t layersAt(const SurfaceHits& hits, std::size_t pixel) {
  return hits.first[pixel + 1] - hits.first[pixel];
}

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

// --- NUMERICS 1.4, E

TEST_P(Rays, E1_TheOrderOfTranslucentSurfacesDoesNotMatter) {
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

TEST(Surfaces, E2_MoreLayersThanARayIsGivenAreJoinedAndReported) {
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

TEST_P(Rays, E3_CoplanarSurfacesHaveOneWinnerOver100Frames) {
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

TEST_P(Rays, E4_ATenthOfAMillimetreAtNearlyTwoMetresIsSeparated) {
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

TEST(Surfaces, E4_ADepthBufferOf24BitsFromATenthOfAMillimetreWouldNotSeparateThem) {
  // Why no depth of that kind is used here: near 0.1, far 10,000 mm, as NUMERICS 1.1 has it.
  const auto z24 = [](double z) { return std::floor(16777215 * (1e4 / (1e4 - 0.1)) * (1 - 0.1 / z)); };
  EXPECT_EQ(z24(1900.0), z24(1900.1));
}

TEST_P(Rays, E5_TheEyeInsideABoxSeesItsWallsEverywhere) {
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

TEST(Surfaces, E6_SliversAndTrianglesSeenEdgeOnLeaveNoHoleAndNoNaN) {
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

TEST(Surfaces, E7_OpacityFromNothingToAll) {
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
