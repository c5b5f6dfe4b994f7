// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/Slice.h"

#include <thread>

#include "SliceVolumes.h"
#include "vernier/base/Threads.h"
#include "vernier/native/Simd.h"

namespace vernier::test {
namespace {

native::SliceJob axialJob(const Volume& volume, double z_vox) {
  const GridGeometry& g = volume.grid();
  native::SliceJob job;
  job.volume = &volume;
  job.width_px = static_cast<int>(g.columns);
  job.height_px = static_cast<int>(g.rows);
  job.picture.right = PatientVec(g.patientFromVoxel.linear[0]);
  job.picture.down = PatientVec(g.patientFromVoxel.linear[1]);
  job.picture.origin = g.patientFromVoxel * VoxelPoint(-0.5, -0.5, z_vox);
  job.window = {500, 1000, VoiFunction::Linear, ""};
  job.background = {0.25, 0.5, 0.75};
  return job;
}

// C3: a plane on the outermost half voxel, moved by rounding, is still in; half a voxel further it is not.
TEST(Slice, PlaneOnAFaceIsInWhateverItsRounding) {
  const auto volume = randomVolume<std::int16_t>(unitGrid(20, 9, 5), 3);
  for (const double face : {-0.5, 0.0, 4.0, 4.5}) {
    for (const double rounding : {-7e-15, 0.0, 7e-15}) {
      native::SliceJob job = axialJob(*volume, face + rounding);
      Images images = imagesFor(job);
      ASSERT_TRUE(native::drawSlice(job, images).ok());
      const std::int64_t slice = face < 1 ? 0 : 4;
      for (int n = 0; n < 180; ++n)
        ASSERT_EQ(images.values[static_cast<std::size_t>(n)],
                  static_cast<float>(volume->modality(n % 20, n / 20, slice)));
    }
  }
  for (const double outside : {-0.501, 4.501, -1e9, 1e9}) {
    native::SliceJob job = axialJob(*volume, outside);
    Images images = imagesFor(job);
    ASSERT_TRUE(native::drawSlice(job, images).ok());
    for (std::size_t n = 0; n < 180; ++n) {
      ASSERT_TRUE(std::isnan(images.values[n]));
      ASSERT_EQ(images.depth[n], kNothing_mm);
      ASSERT_EQ(images.colour[4 * n], 0.25f);
      ASSERT_EQ(images.colour[4 * n + 1], 0.5f);
      ASSERT_EQ(images.colour[4 * n + 2], 0.75f);
      ASSERT_EQ(images.colour[4 * n + 3], 1.0f);
    }
    EXPECT_EQ(images.counters.samples, 0u);
  }
}

TEST(Slice, WindowsAreThoseOfTheStandard) {
  const auto volume = randomVolume<std::int16_t>(everyGrid()[1].grid, 3);
  const std::vector<VoiWindow> windows = {
      {-500, 3000, VoiFunction::Linear, ""},     {-500, 10, VoiFunction::Linear, ""},
      {-500, 1, VoiFunction::Linear, ""},        {0, 10, VoiFunction::LinearExact, ""},
      {-500, 0.5, VoiFunction::LinearExact, ""}, {200, 900, VoiFunction::Sigmoid, ""}};
  for (const VoiWindow& window : windows) {
    for (const bool invert : {false, true}) {
      native::SliceJob job = randomJob(*volume, 11, 90, 70);
      job.window = window;
      job.invert = invert;
      Images images = imagesFor(job);
      ASSERT_TRUE(native::drawSlice(job, images).ok());
      for (int n = 0; n < 90 * 70; ++n) {
        const std::size_t i = static_cast<std::size_t>(n);
        std::uint64_t samples = 0;
        const double truth = pixelTruth(job, n % 90, n / 90, samples).value;
        if (std::isnan(truth)) continue;
        const double grey = invert ? 1 - applyVoi(window, truth) : applyVoi(window, truth);
        // 1e-4 of the window where it is at least 10 units wide; below that the values' own rounding counts.
        const double slack = window.width >= 10 ? 1e-4 : 1e-3 / window.width;
        const bool step = window.width == 1 && std::abs(truth - (window.center - 0.5)) < 1e-2;
        if (!step) {
          ASSERT_NEAR(images.colour[4 * i], grey, slack) << window.width << " pixel " << n;
        }
        ASSERT_EQ(images.colour[4 * i], images.colour[4 * i + 1]);
        ASSERT_EQ(images.colour[4 * i], images.colour[4 * i + 2]);
        ASSERT_EQ(images.colour[4 * i + 3], 1.0f);
      }
    }
  }
}

TEST(Slice, EverySlopeOfItsOwnSlice) {
  VolumeInfo info;
  info.grid = everyGrid()[1].grid;
  info.rescale.clear();
  for (int k = 0; k < 9; ++k) info.rescale.push_back({1.0 + 0.25 * k, -10.0 * k});
  const auto volume = volumeOf<std::int16_t>(info, randomValues<std::int16_t>(7 * 6 * 9, 4, -1000, 1000));
  expectWithinBound(randomJob(*volume, 12, 80, 60), "per-slice rescale");
}

// With a negative slope the greatest modality value is the least stored one.
TEST(Slice, NegativeSlope) {
  VolumeInfo info;
  info.grid = everyGrid()[1].grid;
  info.rescale = {{-2, 100}};
  info.noData = NoDataRange{-5, 12};
  const auto volume = volumeOf<std::int16_t>(info, randomValues<std::int16_t>(7 * 6 * 9, 4, -100, 1000));
  native::SliceJob job = randomJob(*volume, 12, 80, 60);
  ASSERT_TRUE(native::drawsFast(job));
  job.slabSamples = 6;
  for (const SlabMode mode : {SlabMode::Max, SlabMode::Min, SlabMode::Mean}) {
    job.slab = {5.0, mode};
    expectWithinBound(job, "negative slope");
  }
}

TEST(Slice, SameBitsForOneTwoAndThreeThreads) {
  const auto volume = randomVolume<std::int16_t>(everyGrid()[2].grid, 5);
  for (const int slabSamples : {1, 7}) {
    native::SliceJob job = randomJob(*volume, 13, 301, 203);
    job.interpolation = slabSamples > 1 ? Interpolation::Cubic : Interpolation::Linear;
    job.slab.mode = SlabMode::Mean;
    job.slab.thickness_mm = slabSamples > 1 ? 5 : 0;
    job.slabSamples = slabSamples;
    std::vector<Images> results;
    for (const int n : {1, 2, 3}) {
      setThreads(n);
      results.push_back(imagesFor(job));
      ASSERT_TRUE(native::drawSlice(job, results.back()).ok());
    }
    setThreads(0);
    for (std::size_t r = 1; r < results.size(); ++r) {
      EXPECT_EQ(
          0, std::memcmp(results[0].colour.data(), results[r].colour.data(), 4 * results[0].colour.size()));
      EXPECT_EQ(
          0, std::memcmp(results[0].values.data(), results[r].values.data(), 4 * results[0].values.size()));
      EXPECT_EQ(results[0].counters.samples, results[r].counters.samples);
    }
  }
}

TEST(Slice, StopsWhenAsked) {
  const auto volume = randomVolume<std::int16_t>(unitGrid(64, 64, 64), 6);
  native::SliceJob job = randomJob(*volume, 14, 512, 512);
  std::stop_source before;
  before.request_stop();
  Images images = imagesFor(job);
  const Result<void> r = native::drawSlice(job, images, before.get_token());
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::Cancelled);
  EXPECT_EQ(images.counters.samples, 0u);

  // Asked for while it draws: it must not draw to the end. All samples would be 512 * 512 * 100000 of
  // depth 64.
  job.slab = {1000.0, SlabMode::Max};
  job.slabSamples = 100000;
  std::stop_source during;
  std::jthread asker([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    during.request_stop();
  });
  const Result<void> stopped = native::drawSlice(job, images, during.get_token());
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.error().code, ErrorCode::Cancelled);
  EXPECT_LT(images.counters.samples, 400'000'000u);
}

TEST(Slice, FastKernelTakesWhatItCan) {
  const auto fast = [](const GridGeometry& grid, auto sample, double zoomOut) {
    const auto volume = randomVolume<decltype(sample)>(grid, 1);
    native::SliceJob job = randomJob(*volume, 2, 64, 64);
    job.picture.right = zoomOut * job.picture.right;
    return native::drawsFast(job);
  };
  const GridGeometry even = everyGrid()[1].grid, uneven = everyGrid().back().grid;
  EXPECT_TRUE(fast(even, std::uint8_t{}, 1));
  EXPECT_TRUE(fast(even, std::int16_t{}, 1));
  EXPECT_TRUE(fast(even, std::uint16_t{}, 1));
  EXPECT_TRUE(fast(even, float{}, 1));
  EXPECT_FALSE(fast(even, std::int32_t{}, 1));
  EXPECT_FALSE(fast(uneven, std::int16_t{}, 1));
  EXPECT_FALSE(fast(even, std::int16_t{}, 1e3));  // 16 pixels reach over more than 120 voxels
  EXPECT_FALSE(fast(even, std::int16_t{}, 1e9));
  // Cubic reads four voxels along each axis.
  for (const std::int64_t slices : {3, 4}) {
    GridGeometry thin = even;
    thin.slices = slices;
    const auto volume = randomVolume<std::int16_t>(thin, 1);
    native::SliceJob job = randomJob(*volume, 2, 64, 64);
    EXPECT_TRUE(native::drawsFast(job));
    job.interpolation = Interpolation::Cubic;
    EXPECT_EQ(native::drawsFast(job), slices >= 4);
  }
}

TEST(Slice, EveryInstructionSetKeepsTheBound) {
  GridGeometry large = everyGrid()[2].grid;
  large.columns = 70, large.rows = 61, large.slices = 33;  // most tiles lie wholly inside
  const auto volume = randomVolume<std::int16_t>(large, 21);
  const auto floats = randomVolume<float>(large, 22);
  const std::vector<std::string> targets = native::simdTargets();
  ASSERT_FALSE(targets.empty());
  EXPECT_EQ(native::simdTarget(), targets.front());
  std::vector<float> first;
  for (const std::string& target : targets) {
    ASSERT_TRUE(native::useSimdTarget(target));
    EXPECT_EQ(native::simdTarget(), target);
    for (const auto& v : {volume, floats}) {
      native::SliceJob job = randomJob(*v, 23, 193, 70);
      job.picture.right = 0.5 * job.picture.right;
      job.picture.down = 0.5 * job.picture.down;
      job.picture.origin =
          PatientPoint(large.centre().p - 96.5 * job.picture.right.v - 35.0 * job.picture.down.v);
      expectWithinBound(job, target);
      job.slab = {9.0, SlabMode::Mean};
      job.slabSamples = 9;
      expectWithinBound(job, target + " slab");
      job.slabSamples = 3;
      job.interpolation = Interpolation::Cubic;
      expectWithinBound(job, target + " cubic slab");
    }
    const native::SliceJob job = randomJob(*volume, 24, 130, 90);
    Images images = imagesFor(job);
    ASSERT_TRUE(native::drawSlice(job, images).ok());
    if (first.empty()) first = images.values;
    for (std::size_t n = 0; n < first.size(); ++n) {
      ASSERT_EQ(std::isnan(first[n]), std::isnan(images.values[n])) << target;
      if (std::isnan(first[n])) continue;
      ASSERT_NEAR(first[n], images.values[n], 2e-3) << target;  // of 5250
    }
  }
  EXPECT_FALSE(native::useSimdTarget("no such target"));
  EXPECT_TRUE(native::useSimdTarget(""));
}

TEST(Slice, WrongImageSizeIsRefused) {
  const auto volume = randomVolume<std::int16_t>(unitGrid(4, 4, 4), 6);
  const native::SliceJob job = randomJob(*volume, 14, 32, 32);
  Images images;
  images.allocate(32, 31, false);
  const Result<void> r = native::drawSlice(job, images);
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::Internal);
}

}  // namespace
}  // namespace vernier::test
