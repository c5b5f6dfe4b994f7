// SPDX-License-Identifier: GPL-3.0-or-later
// Projections of parts of rays: a lens whose inside equals its outside is not there, by pictures and by
// counts; parts with their weights against closed forms; who owns a sample.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "../volume/Grids.h"
#include "RaysForTest.h"
#include "vernier/base/Threads.h"
#include "vernier/native/Projection.h"

namespace vernier {
namespace {

using native::ProjectionJob;
using Which = RaysOfPass::Which;

// Of all that can be joined from two appearances; a mean cannot.
constexpr ProjectionMode kJoined[] = {ProjectionMode::Max, ProjectionMode::Min, ProjectionMode::Sum,
                                      ProjectionMode::Attenuation};

Accumulator accumulatorOf(ProjectionMode mode) {
  return mode == ProjectionMode::Max   ? Accumulator::Max
         : mode == ProjectionMode::Min ? Accumulator::Min
         : mode == ProjectionMode::Sum ? Accumulator::Sum
                                       : Accumulator::Attenuation;
}

struct Case {
  std::shared_ptr<const Volume> volume;
  std::shared_ptr<const native::ProjectionBounds> bounds;
  ProjectionJob job;
  std::vector<HalfSpace> lens;

  Images draw(const RaysOfPass& rays = {}, std::shared_ptr<RayIntervals> cut = nullptr) const {
    Images images;
    images.rays = std::move(cut);
    draw(rays, images);
    return images;
  }
  void draw(const RaysOfPass& rays, Images& images) const {
    ProjectionJob part = job;
    part.rays = rays;
    const Result<void> drawn = native::drawProjection(part, images);
    ASSERT_TRUE(drawn.ok()) << (drawn.ok() ? "" : drawn.error().text());
  }
  std::shared_ptr<RayIntervals> cut() const { return test::cutRays(job.camera, job.region, lens); }
};

// Any smooth field of 16-bit values, on a grid that is turned and unequally spaced.
Case smooth(Projection projection = Projection::Orthographic) {
  VolumeInfo info;
  info.grid = test::unitGrid(40, 36, 30);
  const glm::dvec3 x = glm::normalize(glm::dvec3(0.9, 0.3, 0.1));
  const glm::dvec3 z = glm::normalize(glm::cross(x, glm::dvec3(0.1, 0.9, -0.2)));
  info.grid.patientFromVoxel.linear = glm::dmat3(0.8 * x, 0.9 * glm::cross(z, x), 1.3 * z);
  info.grid.patientFromVoxel.translation = {-120, 30, 700};
  std::vector<std::int16_t> v;
  for (int k = 0; k < 30; ++k)
    for (int j = 0; j < 36; ++j)
      for (int i = 0; i < 40; ++i)
        v.push_back(static_cast<std::int16_t>(700 * std::sin(0.4 * i + 0.1 * k) * std::cos(0.3 * j) +
                                              300 * std::sin(0.5 * k)));
  Case c;
  c.volume = test::volumeOf(info, v);
  const GridGeometry& grid = c.volume->grid();
  Camera camera;
  camera.azimuth_deg = 34, camera.elevation_deg = 21, camera.roll_deg = -8, camera.zoom = 1.3;
  camera.projection = projection;
  c.job.volume = c.volume.get();
  c.job.camera = *cameraPicture(camera, {48, 40}, cameraBox(grid));
  c.job.region = *keptRegion({}, grid);
  c.job.window = normalised(VoiWindow{100, 1500, VoiFunction::LinearExact, ""});
  c.job.ramp = depthRamp(c.job.camera, grid);
  c.job.gain_perMm = defaultGain_perMm(grid);
  c.job.step_mm = 0.7;
  c.lens = test::turnedBox(grid.centre() + PatientVec(2, 1, 3), {7, 5, 9});
  return c;
}

void useBounds(Case& c) {
  c.bounds = *native::projectionBounds(*c.volume);
  c.job.bounds = c.bounds.get();
}

int raysThroughLens(const RayIntervals& rays) {
  int n = 0;
  for (std::size_t p = 0; p + 1 < rays.first.size(); ++p) n += rays.meetsLens(p) ? 1 : 0;
  return n;
}

// The largest difference of what a picture shows with a lens that changes nothing.
double changeByLens(const Case& c, Counters* plain = nullptr, Counters* lensed = nullptr) {
  const Images without = c.draw();
  Images with = c.draw({Which::All, 0}, c.cut());
  c.draw({Which::All, 1}, with);
  EXPECT_GT(raysThroughLens(*with.rays), 200);
  if (plain) *plain = without.counters;
  if (lensed) *lensed = with.counters;
  const glm::dvec3 background(c.job.background.r, c.job.background.g, c.job.background.b);
  double most = 0;
  for (std::size_t p = 0; p < without.depth.size(); ++p) {
    const double truth = static_cast<double>(without.colour[4 * p]);
    const double got = with.rays->meetsLens(p)
                           ? test::joined(*with.rays, p, accumulatorOf(c.job.mode), background).x
                           : static_cast<double>(with.colour[4 * p]);
    most = std::max(most, std::abs(got - truth));
  }
  return most;
}

TEST(ProjectionParts, ALensThatChangesNothingIsNotSeen) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const bool bounds : {false, true})
      for (const ProjectionMode mode : kJoined)
        for (const double cue : {0.0, 0.6}) {
          Case c = smooth(projection);
          if (bounds) useBounds(c);
          c.job.mode = mode;
          c.job.cue = mode == ProjectionMode::Max ? cue : 0;
          ASSERT_TRUE(native::samplesFast(c.job));
          EXPECT_LT(changeByLens(c), 2e-6) << static_cast<int>(mode) << " bounds " << bounds;
          c.job.interpolation = Interpolation::Nearest;  // in double, sample by sample
          ASSERT_FALSE(native::samplesFast(c.job));
          EXPECT_LT(changeByLens(c), 1e-6) << static_cast<int>(mode);
        }
}

TEST(ProjectionParts, AnExactLensThatChangesNothingIsNotSeen) {
  for (const ProjectionMode mode : kJoined) {
    Case c = smooth();
    useBounds(c);
    c.job.mode = mode, c.job.exact = true;
    EXPECT_LT(changeByLens(c), 1e-6) << static_cast<int>(mode);
  }
}

// With nothing left out: an extremum takes no other sample, an integral two more for each ray.
TEST(ProjectionParts, ALensThatChangesNothingTakesTwoMoreSamplesARayAtMost) {
  for (const bool fast : {true, false})
    for (const ProjectionMode mode : kJoined) {
      Case c = smooth();
      c.job.mode = mode;
      if (!fast) c.job.interpolation = Interpolation::Nearest;
      Counters plain, lensed;
      changeByLens(c, &plain, &lensed);
      const auto rays = static_cast<std::uint64_t>(raysThroughLens(*c.cut()));
      const bool extreme = mode == ProjectionMode::Max || mode == ProjectionMode::Min;
      EXPECT_GE(lensed.samples, plain.samples);
      EXPECT_LE(lensed.samples, plain.samples + (extreme ? 0 : 2 * rays)) << static_cast<int>(mode) << fast;
    }
}

// A mean over two parts of one appearance, and over the whole.
TEST(ProjectionParts, AMeanOverAllPartsOfAnAppearance) {
  for (const bool exact : {false, true}) {
    Case c = smooth();
    c.job.mode = ProjectionMode::Mean, c.job.exact = exact;
    const Images whole = c.draw();
    auto rays = c.cut();
    for (RaySegment& s : rays->segments) s.appearance = 0;
    const Images parts = c.draw({Which::All, 0}, rays);
    for (std::size_t p = 0; p < whole.depth.size(); ++p)
      if (rays->meetsLens(p)) {
        EXPECT_NEAR(rays->of(p).front().colour[0], whole.colour[4 * p], 1e-6);
        for (const RaySegment& s : rays->of(p).subspan(1)) EXPECT_FALSE(s.covered);
      }
  }
}

// A field of one value: what the parts come to is their lengths and weights.
TEST(ProjectionParts, WeightsAndLengths) {
  Case c = smooth();
  c.volume = test::volumeOf(VolumeInfo(c.volume->info()), std::vector<std::int16_t>(40 * 36 * 30, 475));
  c.job.volume = c.volume.get();  // grey 0.75
  const double gain = c.job.gain_perMm;
  for (const ProjectionMode mode : {ProjectionMode::Max, ProjectionMode::Min, ProjectionMode::Mean,
                                    ProjectionMode::Sum, ProjectionMode::Attenuation}) {
    c.job.mode = mode;
    auto rays = c.cut();
    for (std::size_t p = 0; p + 1 < rays->first.size(); ++p) {
      float weight = 0.9f;
      for (RaySegment& s : rays->of(p)) s.weight = weight, weight *= 0.5f;
    }
    const Images drawn = c.draw({Which::All, 0}, rays);
    int checked = 0;
    for (std::size_t p = 0; p < drawn.depth.size(); ++p) {
      if (rays->of(p).size() != 3) continue;
      const RaySegment& front = rays->of(p)[0];
      const RaySegment& behind = rays->of(p)[2];
      const double a = front.to_mm - front.from_mm, b = behind.to_mm - behind.from_mm;
      const double weighed = 0.9 * a + 0.225 * b;
      double expected = 0;
      switch (mode) {
        case ProjectionMode::Max:
          expected = 0.75 * 0.9;
          break;
        case ProjectionMode::Min:
          expected = 0.75 * 0.225;
          break;
        case ProjectionMode::Mean:
          expected = 0.75 * weighed / (a + b);
          break;
        case ProjectionMode::Sum:
          expected = gain * 0.75 * weighed;
          break;
        case ProjectionMode::Attenuation:
          expected = std::exp(-gain * 0.75 * a);  // each part its own, unweighted
          break;
      }
      // A part without the middle of a step has no sample.
      if ((mode == ProjectionMode::Max || mode == ProjectionMode::Min) && (a < 1 || b < 1)) continue;
      ++checked;
      ASSERT_TRUE(front.covered);
      EXPECT_NEAR(front.colour[0], expected, 2e-6) << static_cast<int>(mode);
      EXPECT_EQ(front.colour[0], front.colour[2]);
      EXPECT_FALSE(rays->of(p)[1].covered);
      EXPECT_EQ(behind.covered, mode == ProjectionMode::Attenuation);
      if (behind.covered) {
        EXPECT_NEAR(behind.colour[0], std::exp(-gain * 0.75 * b), 2e-6);
      }
    }
    EXPECT_GT(checked, 200);
  }
}

// A field that rises along every axis is a straight line along a ray; its greatest value in a part stands at
// one end of it, at the last sample whose step's middle the part holds.
TEST(ProjectionParts, ASampleBelongsToThePartThatHoldsTheMiddleOfItsStep) {
  Case c = smooth();
  std::vector<float> v;
  for (int k = 0; k < 30; ++k)
    for (int j = 0; j < 36; ++j)
      for (int i = 0; i < 40; ++i) v.push_back(static_cast<float>(10 * i - 7 * j + 4 * k));
  c.volume = test::volumeOf(VolumeInfo(c.volume->info()), v);
  c.job.volume = c.volume.get();
  useBounds(c);
  c.job.window = normalised(VoiWindow{0, 1500, VoiFunction::LinearExact, ""});
  const VoxelFromPatient toVoxel = c.volume->voxelFromPatient();
  c.job.step_mm = 1.7;
  for (const ProjectionMode mode : {ProjectionMode::Max, ProjectionMode::Min}) {
    c.job.mode = mode;
    auto rays = c.cut();
    const Images drawn = c.draw({Which::All, 1}, rays);
    int checked = 0, none = 0;
    for (int y = 0; y < drawn.height; ++y)
      for (int x = 0; x < drawn.width; ++x)
        for (const RaySegment& s : rays->of(static_cast<std::size_t>(x + drawn.width * y))) {
          if (s.appearance != 1 || !s.beginsInside || !s.endsInside) continue;
          const PatientRay ray = c.job.camera.ray(x + 0.5, y + 0.5);
          double best = std::numeric_limits<double>::quiet_NaN(), at = 0;
          for (int k = 0; k < 1000; ++k) {
            const double t = (k + 0.5) * c.job.step_mm;
            if (!(t >= static_cast<double>(s.from_mm) && t < static_cast<double>(s.to_mm))) continue;
            const glm::dvec3 p = (toVoxel * ray.at(t)).p;
            const double value = 10 * p.x - 7 * p.y + 4 * p.z;
            if (std::isnan(best) || (mode == ProjectionMode::Max ? value > best : value < best))
              best = value, at = t;
          }
          ASSERT_EQ(s.covered, !std::isnan(best));
          none += s.covered ? 0 : 1;
          if (!s.covered) continue;
          ++checked;
          EXPECT_NEAR(s.colour[0], applyVoi(c.job.window, best), 2e-6);
          EXPECT_NEAR(s.depth_mm, at, 1e-3);
        }
    EXPECT_GT(checked, 200);
    EXPECT_GT(none, 0);
  }
}

TEST(ProjectionParts, DrawsWhatThePassSaysAndNothingElse) {
  Case c = smooth();
  const Images plain = c.draw();
  auto rays = c.cut();
  Images images;
  images.allocate(48, 40, false);
  images.colour.assign(images.colour.size(), -7.0f), images.depth.assign(images.depth.size(), -7.0f);
  images.rays = rays;
  c.draw({Which::All, 1}, images);
  for (const float value : images.colour) ASSERT_EQ(value, -7.0f);
  for (const float value : images.depth) ASSERT_EQ(value, -7.0f);
  for (const RaySegment& s : rays->segments) ASSERT_TRUE(s.appearance == 1 || !s.covered);
  c.draw({Which::All, 0}, images);
  for (std::size_t p = 0; p < plain.depth.size(); ++p) {
    ASSERT_EQ(images.colour[4 * p], rays->meetsLens(p) ? -7.0f : plain.colour[4 * p]) << p;
    ASSERT_EQ(images.depth[p], rays->meetsLens(p) ? -7.0f : plain.depth[p]) << p;
  }
  images.rays->first.pop_back();
  c.job.rays = {Which::All, 0};
  EXPECT_EQ(native::drawProjection(c.job, images).error().code, ErrorCode::Internal);
}

TEST(ProjectionParts, TheSameBitsForAnyNumberOfThreads) {
  Case c = smooth(Projection::Perspective);
  useBounds(c);
  std::vector<float> seen[2];
  for (const int threads : {1, 3}) {
    setThreads(threads);
    Images images = c.draw({Which::All, 0}, c.cut());
    c.draw({Which::All, 1}, images);
    for (const RaySegment& s : images.rays->segments)
      seen[threads == 1 ? 0 : 1].insert(seen[threads == 1 ? 0 : 1].end(), {s.colour[0], s.depth_mm});
  }
  setThreads(0);
  EXPECT_EQ(seen[0], seen[1]);
}

}  // namespace
}  // namespace vernier
