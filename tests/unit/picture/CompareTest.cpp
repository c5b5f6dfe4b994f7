// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace vernier {
namespace {

// Something with edges and slopes.
Picture testCard(int shift = 0) {
  Picture p(64, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const int u = x - shift;
      p.at(x, y)[0] = static_cast<std::uint8_t>(std::clamp(4 * u, 0, 255));
      p.at(x, y)[1] = (u / 8 + y / 8) % 2 ? 220 : 30;
      p.at(x, y)[2] = static_cast<std::uint8_t>(5 * y);
    }
  return p;
}

TEST(Compare, IdenticalIsExactlyZero) {
  const auto d = comparePictures(testCard(), testCard());
  ASSERT_TRUE(d.ok());
  EXPECT_EQ(d->max, 0);
  EXPECT_EQ(d->mean, 0);
  EXPECT_EQ(d->rmse, 0);
  EXPECT_EQ(d->differing, 0);
  EXPECT_EQ(*heatmap(testCard(), testCard()), Picture(64, 48));
}

TEST(Compare, NumbersByHand) {
  Picture a(2, 2, {10, 10, 10}), b = a;
  b.at(1, 0)[2] = 13;
  b.at(0, 1)[0] = 6;
  const auto d = comparePictures(a, b);
  ASSERT_TRUE(d.ok());
  EXPECT_EQ(d->max, 4);
  EXPECT_DOUBLE_EQ(d->mean, 7.0 / 12);
  EXPECT_DOUBLE_EQ(d->rmse, std::sqrt(25.0 / 12));
  EXPECT_DOUBLE_EQ(d->differing, 0.5);
  EXPECT_EQ(d->worstX, 0);
  EXPECT_EQ(d->worstY, 1);
}

// What a comparison must never let pass.
TEST(Compare, MustFail) {
  const Picture good = testCard();
  const auto shifted = comparePictures(good, testCard(1));
  EXPECT_GE(shifted->max, 190);
  EXPECT_GT(shifted->differing, 0.9);
  Picture gamma = good;
  for (std::uint8_t& v : gamma.pixels)
    v = static_cast<std::uint8_t>(std::lround(255 * std::pow(v / 255.0, 1 / 1.1)));
  const auto g = comparePictures(good, gamma);
  EXPECT_GT(g->max, 5);
  EXPECT_GT(g->mean, 2);
  const auto blank = comparePictures(good, Picture(64, 48));
  EXPECT_GT(blank->rmse, 60);
  Picture oneLost = good;
  oneLost.at(33, 20)[1] ^= 0x80;
  const auto one = comparePictures(good, oneLost);
  EXPECT_EQ(one->max, 128);
  EXPECT_DOUBLE_EQ(one->differing, 1.0 / (64 * 48));
  EXPECT_EQ(one->worstX, 33);
  EXPECT_EQ(one->worstY, 20);
}

TEST(Compare, OtherSizesAreRefused) {
  Picture rgba(4, 4);
  rgba.channels = 4;
  rgba.pixels.resize(64);
  for (const Picture& other : {Picture(4, 5), Picture(5, 4), rgba, Picture()}) {
    const auto d = comparePictures(Picture(4, 4), other);
    ASSERT_FALSE(d.ok());
    EXPECT_EQ(d.error().code, ErrorCode::OptionInvalid);
    EXPECT_FALSE(heatmap(Picture(4, 4), other).ok());
  }
  EXPECT_FALSE(comparePictures(Picture(), Picture()).ok()) << "nothing to compare is no agreement";
}

TEST(Compare, HeatGrowsWithTheDifference) {
  double last = 0;
  for (int d = 0; d < 256; ++d) {
    Picture b(1, 1);
    b.pixels[1] = static_cast<std::uint8_t>(d);
    const Picture heat = *heatmap(Picture(1, 1), b);
    if (d == 0) {
      EXPECT_EQ(heat, Picture(1, 1));
    } else if (d == 1) {
      EXPECT_GT(heat.pixels[2], 90) << "one level is seen";
    } else if (d == 255) {
      EXPECT_EQ(heat, Picture(1, 1, {255, 255, 255}));
    }
    // From blue to white each step changes the colour.
    const double key = heat.pixels[0] * 65536.0 + heat.pixels[1] * 256.0 + heat.pixels[2];
    if (d > 0 && d < 24) {
      EXPECT_NE(key, last) << d;
    }
    last = key;
  }
}

}  // namespace
}  // namespace vernier
