// SPDX-License-Identifier: GPL-3.0-or-later
// Rays cut on the CPU against the half-spaces themselves: more than 100,000 random rays, random lenses of all
// shapes, cameras inside and out.
#include <gtest/gtest.h>

#include <cmath>

#include "vernier/base/Random.h"
#include "vernier/lens/Shapes.h"
#include "vernier/native/LensRays.h"

namespace vernier::lens {
namespace {

constexpr int kEdge_px = 64, kCases = 30;
constexpr double kNear_mm = 1e-4;  // of a face a ray may be of two minds; of voxels of 1 mm

struct Dice {
  std::uint64_t seed, next = 0;
  double operator()(double low, double high) { return low + (high - low) * randomUnit(seed, next++); }
};

LensShape shapeOf(Dice& dice, int n) {
  const auto point = [&] { return MeshPoint(dice(-30, 30), dice(-30, 30), dice(-30, 30)); };
  if (n % 4 == 0) return BoxShape{point(), {dice(5, 60), dice(5, 60), dice(5, 60)}};
  if (n % 4 == 1) return SphereShape{point(), dice(5, 60), n % 3 + 1};
  if (n % 4 == 2) return ConeShape{MeshPoint(-20, 0, 0), point(), dice(0, 20), dice(5, 30), 3 + n};
  HullShape hull;
  for (int k = 0; k < 40; ++k) hull.points.push_back(point());
  return hull;
}

struct RandomCase {
  native::LensRaysJob job;
  GridGeometry grid;
};

RandomCase randomCase(int n) {
  Dice dice{static_cast<std::uint64_t>(n) + 7};
  RandomCase c;
  c.grid.columns = 100, c.grid.rows = 90, c.grid.slices = 80;
  c.grid.patientFromVoxel.translation = {-50, -45, -40};
  LensLayer lens;
  lens.shape = shapeOf(dice, n);
  const glm::dvec3 x = glm::normalize(glm::dvec3(1, dice(-1, 1), dice(-1, 1)));
  const glm::dvec3 y = glm::normalize(glm::cross(x, glm::dvec3(dice(-1, 1), 0.3, 1)));
  lens.pose.linear = glm::dmat3(x, y, glm::cross(x, y) * (n % 5 == 0 ? -1.0 : 1.0));
  static DerivedCache cache{64ull << 20};
  const auto region = convexRegion(lens, {}, cache);
  EXPECT_TRUE(region.ok()) << region.error().text();
  c.job.lenses = {*region};
  Scene scene;
  if (n % 3 == 0) scene.clip.push_back({PatientVec(0, 0, 1), 10});
  c.job.region = *keptRegion(scene, c.grid);
  Camera camera;
  camera.azimuth_deg = dice(-180, 180), camera.elevation_deg = dice(-80, 80);
  if (n % 2) camera.projection = Projection::Perspective;
  camera.distance_mm = n % 6 == 5 ? dice(1, 20) : dice(60, 200);  // in the lens, or outside the volume
  c.job.camera = *cameraPicture(camera, {kEdge_px, kEdge_px}, cameraBox(c.grid));
  return c;
}

double leastDistance_mm(const ConvexRegion& lens, PatientPoint p) {
  double least = 1e300;
  for (const HalfSpace& h : lens.planes) least = std::min(least, std::abs(h.distance_mm(p)));
  return least;
}

TEST(LensRays, PointsOnRandomRaysBelongWhereTheHalfSpacesSay) {
  std::size_t rays = 0, through = 0, wrong = 0;
  for (int n = 0; n < kCases; ++n) {
    const RandomCase c = randomCase(n);
    Images images;
    ASSERT_TRUE(native::cutRays(c.job, images).ok());
    const RayIntervals& cut = *images.rays;
    Dice dice{1000 + static_cast<std::uint64_t>(n)};
    for (std::size_t pixel = 0; pixel < kEdge_px * kEdge_px; ++pixel) {
      ++rays;
      const double x = static_cast<double>(pixel % kEdge_px) + 0.5,
                   y = std::floor(static_cast<double>(pixel) / kEdge_px) + 0.5;
      const PatientRay ray = c.job.camera.ray(x, y);
      const RaySpan span = spanOf(ray, c.job.region, 0);
      through += cut.meetsLens(pixel);
      if (span.empty()) {
        EXPECT_FALSE(cut.meetsLens(pixel));
        continue;
      }
      for (int k = 0; k < 4; ++k) {
        const double t = dice(span.entry_mm, span.exit_mm);
        const PatientPoint p = ray.at(t);
        std::int16_t appearance = 0;
        for (const RaySegment& s : cut.of(pixel))
          if (static_cast<double>(s.from_mm) <= t && t <= static_cast<double>(s.to_mm))
            appearance = s.appearance;
        if ((appearance == 1) == c.job.lenses[0]->contains(p)) continue;
        if (leastDistance_mm(*c.job.lenses[0], p) > kNear_mm) ++wrong;
      }
    }
  }
  EXPECT_GT(rays, 100000u);
  EXPECT_GT(through, 15000u);
  EXPECT_EQ(wrong, 0u);
}

TEST(LensRays, TheRasteriserFindsWhatAllFacesSay) {
  std::size_t hits = 0, apart = 0;
  for (int n = 0; n < kCases; ++n) {
    const RandomCase c = randomCase(n);
    const native::LensSpans a = native::lensSpans(*c.job.lenses[0], c.job.camera, false),
                            b = native::lensSpans(*c.job.lenses[0], c.job.camera, true);
    ASSERT_EQ(a.spans.size(), b.spans.size());
    for (std::size_t k = 0; k < a.spans.size(); ++k) {
      const RaySpan &p = a.spans[k], &q = b.spans[k];
      const bool thin = !p.empty() && p.exit_mm - p.entry_mm < kNear_mm;
      if (p.empty() != q.empty()) {
        apart += !thin && !(p.empty() && q.exit_mm - q.entry_mm < kNear_mm);
        continue;
      }
      if (p.empty()) continue;
      ++hits;
      apart += std::abs(p.entry_mm - q.entry_mm) > 1e-6 || std::abs(p.exit_mm - q.exit_mm) > 1e-6;
    }
  }
  EXPECT_GT(hits, 15000u);
  EXPECT_EQ(apart, 0u);
}

}  // namespace
}  // namespace vernier::lens
