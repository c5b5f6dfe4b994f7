// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/quality/OrderStatistic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "vernier/base/Random.h"

namespace vernier::quality {
namespace {

TEST(OrderStatistic, BinomialByHand) {
  EXPECT_NEAR(binomialAtMost(0, 459, 0.01), 0.009921, 1e-6);  // 0.99^459
  EXPECT_NEAR(binomialAtMost(1, 2, 0.5), 0.75, 1e-12);
  EXPECT_NEAR(binomialAtMost(2, 4, 0.25), 0.94921875, 1e-12);  // (81 + 108 + 54) / 256
  EXPECT_EQ(binomialAtMost(4, 4, 0.5), 1);
}

TEST(OrderStatistic, RanksOfLargePictures) {
  EXPECT_EQ(rankForBound(1024, 512 * 512, 0.99, 0.99), 4u);
  EXPECT_EQ(rankForBound(459, 1000 * 459, 0.99, 0.99), 1u);
  EXPECT_EQ(rankForBound(458, 1000000 * std::size_t{458}, 0.99, 0.99), 0u);
  EXPECT_EQ(rankForBound(0, 100, 0.99, 0.99), 0u);
}

TEST(OrderStatistic, AllPixelsTestedIsExact) {
  // Of 1000 pixels 10 may exceed E: E is the 11th largest.
  EXPECT_EQ(rankForBound(1000, 1000, 0.99, 0.99), 11u);
  EXPECT_EQ(rankForBound(50, 50, 0.99, 0.99), 1u);
  EXPECT_EQ(stratifiedSample(1024, 4096, 1).size(), 4096u);
}

TEST(OrderStatistic, SamplesAreSpreadAndNeverTwice) {
  const std::size_t population = 100003;
  const auto s = stratifiedSample(1024, population, 7);
  ASSERT_EQ(s.size(), 1024u);
  EXPECT_EQ(std::set<std::size_t>(s.begin(), s.end()).size(), 1024u);
  for (std::size_t n = 0; n < s.size(); ++n) {
    EXPECT_GE(s[n], n * population / 1024);
    EXPECT_LT(s[n], (n + 1) * population / 1024);
  }
  EXPECT_EQ(s, stratifiedSample(1024, population, 7));
  EXPECT_NE(s, stratifiedSample(1024, population, 8));
}

// In how many of `trials` seeds less than 99 % of the population lies within the stated bound.
int failures(std::size_t population, std::size_t n, int trials,
             const std::function<double(std::size_t)>& error) {
  std::vector<double> all(population);
  for (std::size_t i = 0; i < population; ++i) all[i] = error(i);
  std::vector<double> sorted = all;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t rank = rankForBound(n, population, 0.99, 0.99);
  EXPECT_GE(rank, 1u);
  int failed = 0;
  for (int t = 0; t < trials; ++t) {
    std::vector<double> e;
    for (std::size_t i : stratifiedSample(n, population, static_cast<std::uint64_t>(t))) e.push_back(all[i]);
    std::nth_element(e.begin(), e.begin() + static_cast<std::ptrdiff_t>(rank - 1), e.end(), std::greater<>());
    const double bound = e[rank - 1];
    const auto within = std::upper_bound(sorted.begin(), sorted.end(), bound) - sorted.begin();
    if (static_cast<double>(within) < 0.99 * static_cast<double>(population)) ++failed;
  }
  return failed;
}

// 1 % of 3000 trials are 30; three standard deviations above that are 46. One rank more would fail 2.5 % = 75
// times.
constexpr int kTrials = 3000, kAllowed = 46;

TEST(OrderStatistic, TheBoundHoldsInNinetyNineOfAHundredSeeds) {
  const auto draw = [](std::size_t i) { return randomUnit(5, i); };
  EXPECT_LE(failures(50000, 1024, kTrials, draw), kAllowed);  // uniform
  EXPECT_LE(failures(50000, 1024, kTrials, [&](auto i) { return -std::log(1 - draw(i)); }),
            kAllowed);  // long tail
  EXPECT_LE(failures(50000, 1024, kTrials, [&](auto i) { return std::pow(draw(i), -2.0); }), kAllowed);
  // The worst case: exactly one pixel too many is bad, spread or in one place.
  EXPECT_LE(failures(50000, 1024, kTrials, [](auto i) { return i % 99 == 0 && i / 99 < 501 ? 9.0 : 0.0; }),
            kAllowed);
  EXPECT_LE(failures(50000, 1024, kTrials, [](auto i) { return i >= 20000 && i < 20501 ? 9.0 : 0.0; }),
            kAllowed);
  // Small populations, where strata are of 4 and 5 pixels.
  EXPECT_LE(failures(4500, 1024, kTrials, draw), kAllowed);
  EXPECT_LE(failures(2500, 600, kTrials, draw), kAllowed);
}

TEST(OrderStatistic, TheBoundIsNotEmpty) {
  // It must not hold by being far too large: with the worst case spread, it fails now and then.
  const auto draw = [](std::size_t i) { return randomUnit(5, i); };
  EXPECT_GE(failures(50000, 1024, kTrials, draw), 5);
}

}  // namespace
}  // namespace vernier::quality
