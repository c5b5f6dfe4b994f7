// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Blend.h"

#include <gtest/gtest.h>

namespace vernier {
namespace {

const Picture kA(16, 8, {10, 20, 30}), kB(16, 8, {200, 210, 220});
Rgb8 at(const Picture& p, int x, int y) { return {p.at(x, y)[0], p.at(x, y)[1], p.at(x, y)[2]}; }

TEST(Blend, WipeShowsAOnTheLeftAndBOnTheRight) {
  const auto w = wipe(kA, kB, 0.25);
  ASSERT_TRUE(w.ok());
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x)
      if (x != 4) {
        EXPECT_EQ(at(*w, x, y), x < 4 ? at(kA, 0, 0) : at(kB, 0, 0)) << x;
      }
  EXPECT_EQ(at(*w, 4, 3), (Rgb8{255, 230, 0}));  // the seam is seen
  EXPECT_EQ(*wipe(kA, kB, 0), kB);
  EXPECT_EQ(*wipe(kA, kB, 1), kA);
  EXPECT_FALSE(wipe(kA, kB, 1.5).ok());
}

TEST(Blend, CheckerboardAlternates) {
  const auto c = checkerboard(kA, kB, 4);
  ASSERT_TRUE(c.ok());
  EXPECT_EQ(at(*c, 0, 0), at(kA, 0, 0));
  EXPECT_EQ(at(*c, 4, 0), at(kB, 0, 0));
  EXPECT_EQ(at(*c, 0, 4), at(kB, 0, 0));
  EXPECT_EQ(at(*c, 7, 7), at(kA, 0, 0));
  EXPECT_FALSE(checkerboard(kA, kB, 0).ok());
}

TEST(Blend, SignedDifferenceTellsBrighterFromDarkerAndOneLevelFromNone) {
  Picture a(4, 1, {100, 100, 100}), b = a;
  for (int c = 0; c < 3; ++c) b.at(1, 0)[c] = 200, b.at(2, 0)[c] = 0, b.at(3, 0)[c] = 101;
  const auto d = signedDifference(a, b);
  ASSERT_TRUE(d.ok());
  EXPECT_EQ(at(*d, 0, 0), (Rgb8{25, 25, 25}));     // nothing differs: a as dark grey
  EXPECT_EQ(at(*d, 1, 0), (Rgb8{255, 140, 0}));    // B brighter
  EXPECT_EQ(at(*d, 2, 0), (Rgb8{0, 130, 255}));    // B darker
  EXPECT_GT(at(*d, 3, 0).r, at(*d, 0, 0).r + 20);  // one level is seen
  EXPECT_GT(at(*d, 3, 0).r, at(*d, 3, 0).b);
  // The other way round the signs change.
  const auto back = signedDifference(b, a);
  EXPECT_EQ(at(*back, 1, 0), (Rgb8{0, 130, 255}));
}

TEST(Blend, OtherSizesAreRefused) {
  const Picture narrow(15, 8);
  EXPECT_FALSE(wipe(kA, narrow).ok());
  EXPECT_FALSE(checkerboard(kA, narrow).ok());
  EXPECT_FALSE(signedDifference(kA, narrow).ok());
}

}  // namespace
}  // namespace vernier
