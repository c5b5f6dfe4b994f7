// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Quantise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "vernier/base/Threads.h"
#include "vernier/native/Simd.h"

namespace vernier {
namespace {

TEST(Quantise, RoundsToTheNearestLevelAndClamps) {
  for (int level = 0; level <= 255; ++level) {
    EXPECT_EQ(quantise(static_cast<float>(level / 255.0)), level);
    EXPECT_EQ(quantise(static_cast<float>((level + 0.499) / 255.0)), level);
    EXPECT_EQ(quantise(static_cast<float>((level - 0.499) / 255.0)), level);
  }
  EXPECT_EQ(quantise(-1.0f), 0);
  EXPECT_EQ(quantise(-0.0f), 0);
  EXPECT_EQ(quantise(2.0f), 255);
  EXPECT_EQ(quantise(std::numeric_limits<float>::infinity()), 255);
  EXPECT_EQ(quantise(-std::numeric_limits<float>::infinity()), 0);
  EXPECT_EQ(quantise(0.5f), 128) << "exactly half a level goes up";
}

TEST(Quantise, NotANumberShowsTheMarker) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Images images;
  images.allocate(4, 1, false);
  images.colour = {nan, 0, 0, 1, 0, nan, 0, 1, 0, 0, nan, 1, 0.2f, 0.4f, 0.6f, nan};
  const Picture p = quantise(images);
  ASSERT_EQ(p.channels, 3);
  for (int x = 0; x < 3; ++x) EXPECT_EQ((Rgb8{p.at(x, 0)[0], p.at(x, 0)[1], p.at(x, 0)[2]}), kMarker) << x;
  EXPECT_EQ((Rgb8{p.at(3, 0)[0], p.at(3, 0)[1], p.at(3, 0)[2]}), (Rgb8{51, 102, 153}))
      << "alpha is not stored";
}

TEST(Quantise, LargePicturesAreTheSameForAnyThreads) {
  Images images;
  images.allocate(700, 501, false);
  for (std::size_t i = 0; i < images.colour.size(); ++i)
    images.colour[i] = static_cast<float>(i % 997) / 996.0f;
  setThreads(1);
  const Picture one = quantise(images);
  setThreads(3);
  const Picture three = quantise(images);
  setThreads(0);
  EXPECT_EQ(one, three);
  for (int y : {0, 250, 500})
    for (int x : {0, 13, 699}) {
      const std::size_t i = 4 * (static_cast<std::size_t>(y) * 700 + static_cast<std::size_t>(x));
      EXPECT_EQ(one.at(x, y)[1], quantise(images.colour[i + 1]));
    }
}

// Runs of grey take another way than colour; both give the same levels, also where a run begins, ends or is
// broken.
TEST(Quantise, EveryPixelOfAPictureIsQuantisedAsItsNumbersAre) {
  Images images;
  images.allocate(701, 13, false);
  for (std::size_t i = 0; i < 701 * 13; ++i) {
    const float grey = static_cast<float>(static_cast<double>(i) / 9000.0 * 1.2 - 0.1);
    float* p = &images.colour[4 * i];
    p[0] = p[1] = p[2] = i % 3 == 0 ? static_cast<float>((static_cast<double>(i % 256) + 0.5) / 255.0) : grey;
    if (i > 4000 && i % 97 == 0) p[1] = 0.25f;
    if (i > 7000 && i % 301 == 0) p[0] = p[1] = p[2] = std::numeric_limits<float>::quiet_NaN();
  }
  const Picture picture = quantise(images);
  for (std::size_t i = 0; i < 701 * 13; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float x = images.colour[4 * i + c];
      const std::uint8_t marker[] = {kMarker.r, kMarker.g, kMarker.b};
      ASSERT_EQ(picture.pixels[3 * i + c], std::isnan(x) ? marker[c] : quantise(x)) << i;
    }
}

// The floats at and beside each half level and each level, in colours and in grey, on each instruction set.
TEST(Quantise, TheNeighboursOfEveryHalfLevelAreRoundedAlikeOnEachInstructionSet) {
  std::vector<float> values;
  for (int half = 0; half <= 510; ++half) {
    float x = static_cast<float>(half / 510.0);
    for (int n = 0; n < 4; ++n) x = std::nextafter(x, -1.0f);
    for (int n = 0; n < 9; ++n, x = std::nextafter(x, 2.0f)) values.push_back(x);
  }
  Images images;
  images.allocate(static_cast<int>(values.size()), 2, false);
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      images.colour[4 * i + c] = values[i];
      images.colour[4 * (values.size() + i) + c] = values[(i + c * 1531) % values.size()];
    }
  for (const std::string& target : native::simdTargets()) {
    ASSERT_TRUE(native::useSimdTarget(target));
    const Picture picture = quantise(images);
    native::useSimdTarget("");
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
      ASSERT_EQ(picture.pixels[i], quantise(images.colour[i / 3 * 4 + i % 3])) << target << " " << i;
  }
}

}  // namespace
}  // namespace vernier
