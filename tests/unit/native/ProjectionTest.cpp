// SPDX-License-Identifier: GPL-3.0-or-later
// Projections: the SIMD kernel against the double one, with and without what is left out; exact against
// closed forms and dense samples; counts; no-data.
#include "vernier/native/Projection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../volume/Grids.h"
#include "vernier/base/Threads.h"
#include "vernier/native/Simd.h"
#include "vernier/volume/Sampling.h"

namespace vernier {
namespace {

using native::ProjectionJob;
using test::unitGrid;
using test::volumeOf;

constexpr ProjectionMode kAllModes[] = {ProjectionMode::Max, ProjectionMode::Min, ProjectionMode::Sum,
                                        ProjectionMode::Mean, ProjectionMode::Attenuation};

struct Case {
  std::shared_ptr<const Volume> volume;
  std::shared_ptr<const native::ProjectionBounds> bounds;
  ProjectionJob job;
  Images draw() const {
    Images images;
    images.values.resize(1);
    const Result<void> drawn = native::drawProjection(job, images);
    EXPECT_TRUE(drawn.ok()) << (drawn.ok() ? "" : drawn.error().text());
    return images;
  }
};

Case caseOf(std::shared_ptr<const Volume> volume, Camera camera = {}, View view = {48, 40}) {
  Case c;
  c.volume = std::move(volume);
  const GridGeometry& grid = c.volume->grid();
  c.job.volume = c.volume.get();
  c.job.camera = *cameraPicture(camera, view, cameraBox(grid));
  c.job.region = *keptRegion({}, grid);
  c.job.window = normalised(wholeRange(*c.volume));
  c.job.ramp = depthRamp(c.job.camera, grid);
  c.job.gain_perMm = defaultGain_perMm(grid);
  const glm::dvec3 s = grid.spacing_mm();
  c.job.step_mm = 0.7 * std::min(s.x, std::min(s.y, s.z));
  return c;
}

void useBounds(Case& c) {
  c.bounds = *native::projectionBounds(*c.volume);
  c.job.bounds = c.bounds.get();
}

VolumeInfo obliqueInfo(std::int64_t columns, std::int64_t rows, std::int64_t slices) {
  VolumeInfo info;
  info.grid = unitGrid(columns, rows, slices);
  const glm::dvec3 x = glm::normalize(glm::dvec3(0.9, 0.3, 0.1));
  const glm::dvec3 z = glm::normalize(glm::cross(x, glm::dvec3(0.1, 0.9, -0.2)));
  info.grid.patientFromVoxel.linear = glm::dmat3(0.8 * x, 0.9 * glm::cross(z, x), 1.3 * z);
  info.grid.patientFromVoxel.translation = {-120, 30, 700};
  return info;
}

template <class T>
std::shared_ptr<const Volume> randomVolume(double low, double high, double slope = 1) {
  VolumeInfo info = obliqueInfo(37, 29, 21);
  info.rescale = {ModalityRescale{slope, -100}};
  return volumeOf(info, test::randomValues<T>(37 * 29 * 21, 5, low, high));
}

// A few bright balls in the dark.
std::shared_ptr<const Volume> balls() {
  VolumeInfo info = obliqueInfo(64, 64, 48);
  std::vector<std::int16_t> v;
  for (int k = 0; k < 48; ++k)
    for (int j = 0; j < 64; ++j)
      for (int i = 0; i < 64; ++i) {
        const auto ball = [&](int x, int y, int z) {
          return 1000 * std::exp(-(std::pow(i - x, 2) + std::pow(j - y, 2) + std::pow(k - z, 2)) / 18);
        };
        v.push_back(static_cast<std::int16_t>(ball(20, 30, 10) + ball(45, 40, 30) + 0.7 * ball(30, 12, 38)));
      }
  return volumeOf(info, v);
}

Camera turned(Projection p = Projection::Orthographic) {
  Camera c;
  c.azimuth_deg = 34, c.elevation_deg = 21, c.roll_deg = -8, c.projection = p;
  c.zoom = 1.3;
  return c;
}

double largestDifference(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) && std::isnan(b[i])) continue;
    EXPECT_EQ(std::isnan(a[i]), std::isnan(b[i])) << i;
    most = std::max(most, static_cast<double>(std::abs(a[i] - b[i])));
  }
  return most;
}

// The same lattice in double, by the probe that speaks to people.
double brute(const Case& c, int x, int y) {
  const ProjectionJob& job = c.job;
  const PatientRay ray = job.camera.ray(x + 0.5, y + 0.5);
  const RaySpan span = spanOf(ray, job.region, 0);
  if (span.empty() || !(span.exit_mm > span.entry_mm)) return std::numeric_limits<double>::quiet_NaN();
  const bool extreme = job.mode == ProjectionMode::Max || job.mode == ProjectionMode::Min;
  double best = std::numeric_limits<double>::quiet_NaN(), sum = 0, length = 0;
  for (double k = std::floor(span.entry_mm / job.step_mm) - 1; (k - 1) * job.step_mm < span.exit_mm; ++k) {
    if (!extreme &&
        !(std::min((k + 1) * job.step_mm, span.exit_mm) > std::max(k * job.step_mm, span.entry_mm)))
      continue;
    const double low = std::max(k * job.step_mm, span.entry_mm),
                 high = std::min((k + 1) * job.step_mm, span.exit_mm);
    const double t =
        extreme ? std::clamp((k + 0.5) * job.step_mm, span.entry_mm, span.exit_mm) : (low + high) / 2;
    const auto value = sampleModality(*c.volume, ray.at(t));
    if (!value) continue;
    if (std::isnan(best) || (job.mode == ProjectionMode::Min ? *value < best : *value > best)) best = *value;
    sum += (high - low) * (job.mode == ProjectionMode::Mean ? *value : applyVoi(job.window, *value));
    length += high - low;
  }
  if (extreme) return best;
  if (job.mode == ProjectionMode::Mean) return length > 0 ? sum / length : best;
  return job.gain_perMm * sum;
}

void expectAsBrute(Case& c, double tolerance) {
  const auto range = c.volume->modalityRange();
  for (ProjectionMode mode : kAllModes) {
    c.job.mode = mode;
    const double ofRange = mode == ProjectionMode::Sum || mode == ProjectionMode::Attenuation
                               ? 0
                               : 1e-6 * (range->max - range->min);  // float keeps that much of it
    ASSERT_TRUE(native::samplesFast(c.job));
    const Images images = c.draw();
    int shown = 0;
    for (int y = 0; y < images.height; y += 3)
      for (int x = 0; x < images.width; x += 3) {
        const double truth = brute(c, x, y);
        const float got = images.values[static_cast<std::size_t>(x + images.width * y)];
        if (std::isnan(truth)) continue;
        ++shown;
        EXPECT_NEAR(static_cast<double>(got), truth, tolerance * (1 + std::abs(truth)) + ofRange)
            << static_cast<int>(mode) << " at " << x << "," << y;
      }
    EXPECT_GT(shown, 50);
  }
}

TEST(Projection, EveryTypeIsTheLatticeInDouble) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
    std::vector<std::shared_ptr<const Volume>> volumes{
        randomVolume<std::uint8_t>(0, 255), randomVolume<std::uint16_t>(0, 65535),
        randomVolume<std::int16_t>(-32768, 32767, -0.5), randomVolume<float>(-1, 1, 3), balls()};
    for (auto& v : volumes) {
      Case c = caseOf(v, turned(projection));
      useBounds(c);
      expectAsBrute(c, 2e-5);
    }
  }
}

// An eye inside the volume: rays begin at the eye.
TEST(Projection, AnEyeInside) {
  Camera camera = turned(Projection::Perspective);
  camera.distance_mm = 3, camera.fov_deg = 80;
  Case c = caseOf(balls(), camera);
  useBounds(c);
  expectAsBrute(c, 2e-5);
}

TEST(Projection, WhatIsLeftOutChangesNothing) {
  for (const auto& volume : {balls(), randomVolume<std::uint16_t>(0, 1000)})
    for (ProjectionMode mode : kAllModes)
      for (double cue : {0.0, 0.6}) {
        if (cue > 0 && mode != ProjectionMode::Max) continue;
        Case c = caseOf(volume, turned(Projection::Perspective));
        c.job.mode = mode, c.job.cue = cue;
        c.job.window.center += 0.2 * c.job.window.width;  // much is dark
        const Images all = c.draw();
        useBounds(c);
        const Images some = c.draw();
        const bool extreme = mode == ProjectionMode::Max || mode == ProjectionMode::Min;
        if (extreme) {
          EXPECT_EQ(all.colour, some.colour) << static_cast<int>(mode);
        } else {
          EXPECT_LT(largestDifference(all.colour, some.colour), 1e-6);
        }
        EXPECT_LE(some.counters.samples, all.counters.samples);
      }
}

TEST(Projection, LeavesOutWhatCannotMatter) {
  Case c = caseOf(balls(), turned());
  const std::uint64_t all = c.draw().counters.samples;
  useBounds(c);
  EXPECT_LT(c.draw().counters.samples, all);  // a maximum: of the dark rays all are alike
  c.job.mode = ProjectionMode::Sum;
  c.job.window = {800, 200, VoiFunction::LinearExact, ""};
  EXPECT_LT(c.draw().counters.samples, all / 5);  // little emits
  c.job.window = {3000, 200, VoiFunction::LinearExact, ""};
  EXPECT_EQ(c.draw().counters.samples, 0u);  // nothing does
}

TEST(Projection, TheSameBitsForAnyThreadsAndTheSamePictureForAnySimd) {
  Case c = caseOf(balls(), turned(Projection::Perspective));
  useBounds(c);
  for (ProjectionMode mode : kAllModes) {
    c.job.mode = mode;
    setThreads(1);
    const Images one = c.draw();
    for (int n : {2, 3}) {
      setThreads(n);
      EXPECT_EQ(c.draw().colour, one.colour);
    }
    setThreads(0);
    for (const std::string& target : native::simdTargets()) {
      ASSERT_TRUE(native::useSimdTarget(target));
      EXPECT_LT(largestDifference(c.draw().colour, one.colour), 3e-6) << target;
    }
    native::useSimdTarget("");
  }
}

TEST(Projection, ConstantAndLinearFieldsAreKnown) {
  VolumeInfo info = obliqueInfo(12, 10, 9);
  const Case constant = [&] {
    Case c = caseOf(volumeOf(info, std::vector<float>(12 * 10 * 9, 7.0f)), turned());
    c.job.window = {7, 2, VoiFunction::LinearExact, ""};  // grey 1/2
    c.job.mode = ProjectionMode::Sum;
    c.job.gain_perMm = 0.25;
    return c;
  }();
  for (const bool exact : {false, true}) {
    Case c = constant;
    useBounds(c);
    c.job.exact = exact;
    const Images sum = c.draw();
    c.job.mode = ProjectionMode::Attenuation;
    const Images left = c.draw();
    for (int y = 0; y < sum.height; ++y)
      for (int x = 0; x < sum.width; ++x) {
        const RaySpan span = spanOf(c.job.camera.ray(x + 0.5, y + 0.5), c.job.region, 0);
        const double length = span.empty() ? 0 : span.exit_mm - span.entry_mm;
        const std::size_t at = 4 * static_cast<std::size_t>(x + sum.width * y);
        EXPECT_NEAR(sum.colour[at], 0.125 * length, 2e-6 * (1 + length));
        EXPECT_NEAR(left.colour[at], std::exp(-0.125 * length), 2e-6);
      }
  }
  std::vector<float> ramp;
  for (int k = 0; k < 9; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 12; ++i) ramp.push_back(static_cast<float>(2 * i - 3 * j + 5 * k));
  Case c = caseOf(volumeOf(info, ramp), turned());
  useBounds(c);
  c.job.exact = true;
  const Images high = c.draw();
  const auto field = [&](PatientPoint p) {
    const VoxelPoint v = c.volume->voxelFromPatient() * p;
    return 2 * v.p.x - 3 * v.p.y + 5 * v.p.z;
  };
  for (int y = 0; y < high.height; ++y)
    for (int x = 0; x < high.width; ++x) {
      const PatientRay ray = c.job.camera.ray(x + 0.5, y + 0.5);
      const RaySpan span = spanOf(ray, c.job.region, 0);
      if (span.empty() || span.exit_mm - span.entry_mm < 1e-6) continue;
      const double truth = std::max(field(ray.at(span.entry_mm)), field(ray.at(span.exit_mm)));
      EXPECT_NEAR(high.values[static_cast<std::size_t>(x + high.width * y)], truth, 1e-5);
    }
}

// The limit of ever smaller steps, from below.
TEST(Projection, ExactIsWhatSamplesComeCloseTo) {
  for (const auto& volume : {balls(), randomVolume<std::uint16_t>(0, 1000)})
    for (ProjectionMode mode : kAllModes) {
      Case c = caseOf(volume, turned(Projection::Perspective), {24, 20});
      useBounds(c);
      c.job.mode = mode;
      c.job.exact = true;
      const Images exact = c.draw();
      c.job.exact = false;
      double before = 1e300;
      for (double finer : {4.0, 16.0, 64.0}) {
        Case d = c;
        d.job.step_mm = c.job.step_mm / finer;
        const Images sampled = d.draw();
        const double off = largestDifference(sampled.colour, exact.colour);
        EXPECT_LT(off, before + 1e-5) << static_cast<int>(mode);
        before = off;
        if (mode == ProjectionMode::Max) {
          for (std::size_t i = 0; i < exact.values.size(); ++i)
            if (!std::isnan(exact.values[i])) {
              EXPECT_LE(sampled.values[i], exact.values[i] * (1 + 1e-6f) + 1e-3f);
            }
        }
      }
      EXPECT_LT(before, 0.01) << static_cast<int>(mode);
    }
}

TEST(Projection, NoDataTakesNoPart) {
  VolumeInfo info = obliqueInfo(37, 29, 21);
  info.noData = NoDataRange{3000, 4000};  // would win every maximum
  std::vector<std::int16_t> v = test::randomValues<std::int16_t>(37 * 29 * 21, 3, 0, 1000);
  for (std::size_t i = 0; i < v.size(); i += 7) v[i] = 3500;
  for (std::size_t i = 37 * 29 * 5; i < 37 * 29 * 8; ++i) v[i] = 3500;
  Case c = caseOf(volumeOf(info, v), turned());
  useBounds(c);
  expectAsBrute(c, 2e-5);
  EXPECT_NE(native::whyNotExact(c.job), "");
}

TEST(Projection, UnevenSlicesAndNearestGoTheGeneralWay) {
  for (const test::NamedGrid& g : test::everyGrid()) {
    VolumeInfo info;
    info.grid = g.grid;
    const auto n = static_cast<std::size_t>(g.grid.columns * g.grid.rows * g.grid.slices);
    for (Interpolation how : {Interpolation::Linear, Interpolation::Nearest}) {
      Case c = caseOf(volumeOf(info, test::randomValues<std::int16_t>(n, 3, 0, 1000)), turned());
      c.job.interpolation = how;
      EXPECT_EQ(native::samplesFast(c.job), g.grid.even() && how == Interpolation::Linear) << g.name;
      const Images images = c.draw();
      const auto shown = std::count_if(images.values.begin(), images.values.end(),
                                       [](float x) { return x >= 0 && x <= 1000; });
      EXPECT_GT(shown, 100) << g.name;
    }
  }
}

TEST(Projection, TheCueIsGreyByDepth) {
  for (const Projection p : {Projection::Orthographic, Projection::Perspective}) {
    VolumeInfo info = obliqueInfo(12, 10, 9);
    Case c = caseOf(volumeOf(info, std::vector<float>(12 * 10 * 9, 7.0f)), turned(p));
    c.job.window = {6, 2, VoiFunction::LinearExact, ""};  // grey 1
    c.job.cue = 0.75;
    const Images images = c.draw();
    for (int y = 0; y < images.height; ++y)
      for (int x = 0; x < images.width; ++x) {
        const PatientRay ray = c.job.camera.ray(x + 0.5, y + 0.5);
        const RaySpan span = spanOf(ray, c.job.region, 0);
        if (span.empty() || span.exit_mm - span.entry_mm < c.job.step_mm) continue;
        const std::size_t at = static_cast<std::size_t>(x + images.width * y);
        EXPECT_LT(images.depth[at] - span.entry_mm, c.job.step_mm);  // the nearest sample wins
        const double depth = images.depth[at] / c.job.camera.rayPerDepth(x + 0.5, y + 0.5);
        EXPECT_NEAR(images.colour[4 * at], 0.25 + 0.75 * c.job.ramp.at(depth), 2e-5);
      }
  }
}

TEST(Projection, SaysWhatItCannot) {
  Case c = caseOf(balls());
  EXPECT_EQ(native::whyNotExact(c.job), "");
  c.job.cue = 0.5;
  EXPECT_NE(native::whyNotExact(c.job).find("depth cue"), std::string::npos);
  c.job.cue = 0, c.job.interpolation = Interpolation::Nearest;
  EXPECT_NE(native::whyNotExact(c.job).find("nearest"), std::string::npos);
  c.job.exact = true;
  Images images;
  EXPECT_EQ(native::drawProjection(c.job, images).error().code, ErrorCode::Internal);
  std::stop_source stop;
  stop.request_stop();
  c.job.exact = false;
  EXPECT_EQ(native::drawProjection(c.job, images, stop.get_token()).error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace vernier
