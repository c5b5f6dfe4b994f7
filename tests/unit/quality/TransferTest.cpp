// SPDX-License-Identifier: GPL-3.0-or-later
// The reference's own reading of transfer functions, against that of module volume, and its cuts of a piece
// against small steps; the quadrature of emission and absorption.
#include <cmath>

#include "FrontToBack.h"
#include "Scenes.h"
#include "Transfer.h"
#include "vernier/base/Random.h"

namespace vernier::quality {
namespace {

// Random points, some of them steps, some at values that tests hit exactly.
TransferFunction randomFunction(std::uint64_t seed) {
  const auto draw = [&](std::uint64_t n) { return randomUnit(seed, n); };
  TransferFunction f;
  f.opacityLength_mm = 0.5 + draw(0);
  double value = draw(1) - 0.5;
  const auto count = 1 + static_cast<int>(6 * draw(2));
  for (int n = 0; n < count; ++n) {
    const auto k = static_cast<std::uint64_t>(10 * n);
    f.opacities.push_back({value, draw(20 + k) < 0.4 ? 0.0 : draw(21 + k)});
    if (draw(22 + k) < 0.4) f.opacities.push_back({value, draw(23 + k)});
    if (draw(24 + k) < 0.6) f.colours.push_back({value, {draw(25 + k), draw(26 + k), draw(27 + k)}});
    value += 0.05 + 0.3 * draw(28 + k);
  }
  if (f.colours.empty() || draw(3) < 0.3) f.colours.push_back({value, {0.1, 0.2, 0.3}});
  if (draw(4) < 0.3)
    f.colours.push_back({value + 0.1, {1, 0, 0.5}}), f.colours.push_back({value + 0.1, {0, 1, 0}});
  return f;
}

TEST(Transfer, ReadsAsModuleVolumeDoes) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const TransferFunction f = randomFunction(seed);
    const auto t = Transfer::make(f);
    ASSERT_TRUE(t.ok()) << t.error().text();
    std::vector<double> values = knotsOf(f);
    for (int n = 0; n < 40; ++n)
      values.push_back(3 * randomUnit(seed + 1000, static_cast<std::uint64_t>(n)) - 1);
    for (double v : values) {
      const std::size_t i = t->at(v);
      EXPECT_NEAR(t->opacity(i, v), opacityAt(f, v), 1e-14) << seed << ' ' << v;
      const glm::dvec3 off = glm::abs(t->colour(i, v) - colourAt(f, v));
      EXPECT_LT(std::max({off.x, off.y, off.z}), 1e-14) << seed << ' ' << v;
      if (opacityAt(f, v) < 1) {
        EXPECT_NEAR(t->extinction_perMm(i, v), extinctionAt_perMm(f, v), 1e-12);
      }
      // All values in between, by the greatest opacity, unless a point that only touches is the greatest.
      for (double w : values)
        if (w >= v && greatestOpacity(f, v, w) > 0 && !t->showsIn(v, w)) {
          for (int n = 0; n <= 1000; ++n)
            EXPECT_EQ(opacityAt(f, v + (w - v) * n / 1000.0), 0) << v << ' ' << w;
        } else if (w >= v && greatestOpacity(f, v, w) == 0) {
          EXPECT_FALSE(t->showsIn(v, w)) << v << ' ' << w;
        }
    }
  }
}

// A jump is where two points of one value differ, and nothing else: not what rounding makes of a bend.
TEST(Transfer, StepsAreCounted) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const TransferFunction f = randomFunction(seed);
    const auto t = Transfer::make(f);
    ASSERT_TRUE(t.ok());
    std::size_t jumps = 0;
    for (double v : knotsOf(f)) {
      bool jump = false;
      for (std::size_t n = 1; n < f.opacities.size(); ++n)
        jump = jump || (f.opacities[n].value == v && f.opacities[n - 1].value == v &&
                        f.opacities[n].opacity != f.opacities[n - 1].opacity);
      for (std::size_t n = 1; n < f.colours.size(); ++n)
        jump = jump || (f.colours[n].value == v && f.colours[n - 1].value == v &&
                        f.colours[n].colour != f.colours[n - 1].colour);
      jumps += jump ? 1 : 0;
      EXPECT_EQ(t->stepsUpTo(t->at(v)), jumps) << seed << ' ' << v;
      EXPECT_EQ(t->isStep(t->at(v)), jump) << seed << ' ' << v;
    }
    EXPECT_EQ(t->steps(), jumps);
  }
}

// Along rising and falling cubics: each place lies in the interval that was named for it, and what was left
// out is clear.
TEST(Transfer, CutsMonotonePieces) {
  int stretches = 0, knots = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto t = Transfer::make(randomFunction(seed));
    ASSERT_TRUE(t.ok());
    for (const bool rising : {true, false}) {
      Piece p;
      p.numerator.degree = 3;
      p.numerator.c[0] = rising ? -0.6 : 2;
      for (std::size_t n = 1; n < 4; ++n)
        p.numerator.c[n] = (rising ? 1.2 : -1.2) * randomUnit(seed, 500 + n);
      std::vector<double> named;
      double last = 0;
      const bool whole = t->along(
          p, 0, 1,
          [&](std::size_t interval, double from, double to) {
            ++stretches;
            EXPECT_LE(last, from);
            EXPECT_LT(from, to);
            last = to;
            named.push_back(from), named.push_back(to);
            for (double share : {1e-6, 0.5, 1 - 1e-6}) {
              const double u = from + share * (to - from);
              if (to - from > 1e-9) {
                EXPECT_EQ(t->at(p(u)), interval);
              }
            }
            return true;
          },
          [&](std::size_t a, std::size_t b, double u) {
            ++knots;
            EXPECT_NEAR(p(u), t->lo(std::max(a, b)), 1e-12);
            return true;
          });
      EXPECT_TRUE(whole);
      for (int n = 0; n < 200; ++n) {
        const double u = (n + 0.5) / 200;
        bool inside = false;
        for (std::size_t k = 0; k < named.size(); k += 2)
          inside = inside || (u >= named[k] && u <= named[k + 1]);
        EXPECT_TRUE(inside || t->opacity(t->at(p(u)), p(u)) == 0) << seed << " " << u;
      }
    }
  }
  EXPECT_GT(stretches, 400);
  EXPECT_GT(knots, 400);
}

TEST(Transfer, WhatIsWrongIsRefused) {
  TransferFunction f = randomFunction(1);
  f.opacities.clear();
  EXPECT_EQ(Transfer::make(f).error().code, ErrorCode::SceneInvalid);
}

TEST(FrontToBack, RulesAreExactForPolynomials) {
  const auto check = [](const auto& rule, int places) {
    for (int power = 0; power < 2 * places; ++power) {
      double sum = 0;
      for (std::size_t n = 0; n < rule.at.size(); ++n) sum += rule.weight[n] * std::pow(rule.at[n], power);
      EXPECT_NEAR(sum, 1.0 / (power + 1), 1e-15);
      if (power >= places) continue;
      for (std::size_t i = 0; i < rule.at.size(); ++i) {
        double part = 0;
        for (std::size_t j = 0; j < rule.at.size(); ++j)
          part += rule.upTo[i][j] * std::pow(rule.at[j], power);
        EXPECT_NEAR(part, std::pow(rule.at[i], power + 1) / (power + 1), 1e-14);
      }
    }
  };
  check(gaussRule<2>(), 2);
  check(gaussRule<4>(), 4);
  check(gaussRule<8>(), 8);
}

// Optical depth 2 k u, colour u: C = integral of 2 k u^2 exp(-k u^2); with x = sqrt(k): sqrt(pi)/(2 x) erf(x)
// - exp(-k). From thin to so dense that all happens in the first thousandth.
TEST(FrontToBack, ThinAndDense) {
  for (double k : {1e-9, 0.01, 1.0, 30.0, 1e4, 1e7}) {
    FrontToBack light;
    light.absorb([&](double u) { return Emission{2 * k * u, glm::dvec3(u, 1, 0)}; }, 0, 1);
    const double x = std::sqrt(k);
    EXPECT_NEAR(light.colour.x,
                k < 1e-6 ? 2 * k / 3 : std::sqrt(std::acos(-1.0)) / (2 * x) * std::erf(x) - std::exp(-k),
                2e-7)
        << k;
    EXPECT_NEAR(light.colour.y, -std::expm1(-k), 2e-7) << k;
    EXPECT_NEAR(light.left, std::exp(-k), 2e-7);
    EXPECT_EQ(light.colour.z, 0);
  }
}

}  // namespace
}  // namespace vernier::quality
