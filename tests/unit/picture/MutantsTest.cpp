// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Mutants.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vernier/picture/Compare.h"

namespace vernier {
namespace {

void box(Picture& p, int x0, int y0, int x1, int y1, Rgb8 c) {
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) p.at(x, y)[0] = c.r, p.at(x, y)[1] = c.g, p.at(x, y)[2] = c.b;
}

// A large thing, one of 5 x 4 pixels, and a speck that is no object.
Picture scene() {
  Picture p(48, 32);
  box(p, 4, 4, 24, 20, {200, 180, 90});
  box(p, 30, 20, 35, 24, {120, 120, 120});
  box(p, 40, 2, 42, 4, {80, 0, 0});
  return p;
}

TEST(Mutants, FactsByHand) {
  const PictureFacts f = factsOf(scene());
  EXPECT_EQ(f.colours, 4);
  EXPECT_DOUBLE_EQ(f.covered, (20 * 16 + 20 + 4) / (48.0 * 32));
  Picture half(2, 1);
  box(half, 1, 0, 2, 1, {100, 100, 100});
  EXPECT_DOUBLE_EQ(factsOf(half).sd, 50);
  EXPECT_EQ(factsOf(Picture(3, 3)).covered, 0);
}

TEST(Mutants, EachIsWhatItSays) {
  const Picture p = scene();
  const Picture right = mutantOf(p, Mutant::ShiftedRight), down = mutantOf(p, Mutant::ShiftedDown);
  const Picture mirrored = mutantOf(p, Mutant::Mirrored), gamma = mutantOf(p, Mutant::Gamma);
  for (int y = 1; y < p.height; ++y)
    for (int x = 1; x < p.width; ++x)
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(right.at(x, y)[c], p.at(x - 1, y)[c]);
        EXPECT_EQ(down.at(x, y)[c], p.at(x, y - 1)[c]);
        EXPECT_EQ(mirrored.at(x, y)[c], p.at(47 - x, y)[c]);
        EXPECT_EQ(gamma.at(x, y)[c], std::lround(255 * std::pow(p.at(x, y)[c] / 255.0, 1 / 1.1)));
      }
  EXPECT_EQ(mutantOf(p, Mutant::Blank), Picture(48, 32));
  // The small object goes; the large one and the speck stay.
  Picture without = p;
  box(without, 30, 20, 35, 24, {});
  EXPECT_EQ(mutantOf(p, Mutant::ObjectMissing), without);
}

TEST(Mutants, WithoutAnObjectTheLargestSpeckGoes) {
  Picture p(20, 20), without(20, 20);
  box(p, 2, 2, 4, 4, {90, 90, 90});
  box(p, 10, 10, 11, 11, {90, 90, 90});
  box(without, 10, 10, 11, 11, {90, 90, 90});
  EXPECT_EQ(mutantOf(p, Mutant::ObjectMissing), without);
}

TEST(Mutants, NamesGoThereAndBack) {
  for (const Mutant m : kMutants) EXPECT_EQ(mutantNamed(nameOf(m)), m);
  EXPECT_FALSE(mutantNamed("rotated"));
}

TEST(Mutants, AllAreToldByTheComparator) {
  for (const Mutant m : kMutants) {
    const auto d = comparePictures(scene(), mutantOf(scene(), m));
    ASSERT_TRUE(d.ok());
    EXPECT_GT(d->max, 2) << nameOf(m);
  }
}

TEST(Mutants, HistogramCountsPixelsByTheirLargestDifference) {
  Picture a(3, 1), b(3, 1);
  b.at(1, 0)[0] = 5, b.at(1, 0)[2] = 9;
  b.at(2, 0)[1] = 255;
  const auto n = differenceHistogram(a, b);
  ASSERT_TRUE(n.ok());
  EXPECT_EQ((*n)[0], 1u);
  EXPECT_EQ((*n)[5], 0u);
  EXPECT_EQ((*n)[9], 1u);
  EXPECT_EQ((*n)[255], 1u);
  EXPECT_FALSE(differenceHistogram(a, Picture(1, 3)).ok());
}

}  // namespace
}  // namespace vernier
