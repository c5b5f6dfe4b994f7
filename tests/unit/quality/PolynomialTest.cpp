// SPDX-License-Identifier: GPL-3.0-or-later
#include "Polynomial.h"

#include <gtest/gtest.h>

#include "vernier/base/Random.h"

namespace vernier::quality {
namespace {

Poly linear(double root) { return Poly{{-root, 1}, 1}; }

TEST(Polynomial, RootsOfProductsAreFound) {
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    const int degree = 1 + static_cast<int>(trial % 5);
    std::vector<double> expected;
    Poly p{{trial % 2 ? 3.0 : -0.01}, 0};
    for (int n = 0; n < degree; ++n) {
      const double root = -0.5 + 2 * randomUnit(trial, static_cast<std::uint64_t>(n));
      p = p * linear(root);
      if (root > 0 && root < 1) expected.push_back(root);
    }
    std::sort(expected.begin(), expected.end());
    const std::vector<double> got = rootsInside(p);
    ASSERT_EQ(got.size(), expected.size()) << trial;
    for (std::size_t n = 0; n < got.size(); ++n) EXPECT_NEAR(got[n], expected[n], 1e-6) << trial;
  }
}

TEST(Polynomial, QuadraticKeepsTheSmallRoot) {
  // (u - 1e-9)(u + 1e6): the textbook formula loses the small root.
  const Poly p = linear(1e-9) * linear(-1e6);
  const auto r = rootsInside(p);
  ASSERT_EQ(r.size(), 1u);
  EXPECT_NEAR(r[0], 1e-9, 1e-18);
}

TEST(Polynomial, NoRootOfAConstantOrOfNothing) {
  EXPECT_TRUE(rootsInside(Poly{{0}, 0}).empty());
  EXPECT_TRUE(rootsInside(Poly{{2}, 0}).empty());
  EXPECT_TRUE(rootsInside(Poly{{1, 0, 1}, 2}).empty());
}

TEST(Polynomial, MixIsALerp) {
  const Poly p = mix(Poly{{2}, 0}, Poly{{6}, 0}, line(0.25, 0.75));
  EXPECT_EQ(p(0), 3);
  EXPECT_EQ(p(1), 5);
  EXPECT_EQ(derivative(p)(0.3), 2);
}

}  // namespace
}  // namespace vernier::quality
