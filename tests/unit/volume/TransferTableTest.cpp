// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/TransferTable.h"

#include <gtest/gtest.h>

#include "vernier/base/Threads.h"

namespace vernier {
namespace {

using Rgba = std::array<double, 4>;

TransferFunction bent() {
  return {{{-400, {.62, .36, .22}}, {60, {.85, .45, .35}}, {300, {1, .85, .70}}, {1200, {.2, 1, .95}}},
          {{-400, 0}, {-100, .015}, {60, .03}, {200, .06}, {400, .3}, {1200, .8}},
          1};
}

// Steps in both lists, and stretches without opacity and without light.
TransferFunction stepped() {
  return {{{0, {1, 0, 0}}, {50, {0, 1, 0}}, {50, {0, 0, 1}}, {100, {1, 1, 1}}},
          {{20, 0}, {20, .4}, {45, .9}, {45, 0}, {70, 0}, {80, 1}, {80, .02}},
          1.5};
}

TransferFunction extreme() {
  return {{{0, {0, 0, 0}}, {100, {1, .5, .25}}},
          {{0, 0}, {20, 1 - 1e-7}, {40, 1}, {60, 1}, {60, 0}, {90, 1e-7}, {100, 1}},
          0.7};
}

// Many thin layers, front to back, in long double.
Rgba bruteForce(const TransferFunction& f, double front, double back, double step_mm, int layers) {
  long double through = 1, c[3] = {0, 0, 0};
  for (int n = 0; n < layers; ++n) {
    const double value = front + (back - front) * (n + 0.5) / layers;
    const double a = opacityAt(f, value);
    const long double left =
        a >= 1 ? 0 : std::pow(1 - static_cast<long double>(a), step_mm / f.opacityLength_mm / layers);
    const glm::dvec3 colour = colourAt(f, value);
    for (int k = 0; k < 3; ++k) c[k] += through * (1 - left) * static_cast<long double>(colour[k]);
    through *= left;
  }
  return {double(c[0]), double(c[1]), double(c[2]), double(1 - through)};
}

Rgba entry(const PreIntegratedTable& t, int front, int back) {
  Rgba out;
  for (std::size_t c = 0; c < 4; ++c)
    out[c] = double(t.rgba[4 * (std::size_t(front) + std::size_t(t.size) * std::size_t(back)) + c]);
  return out;
}

void expectBruteForce(const TransferFunction& f, Volume::Range range, double step_mm, int size, int layers,
                      double within) {
  const auto t = makePreIntegratedTable(f, range, step_mm, size);
  ASSERT_TRUE(t) << t.error().sentence;
  for (int front = 0; front < size; ++front)
    for (int back = 0; back < size; ++back) {
      const Rgba truth = bruteForce(f, t->valueOf(front), t->valueOf(back), step_mm, layers),
                 is = entry(*t, front, back);
      for (std::size_t c = 0; c < 4; ++c)
        ASSERT_NEAR(is[c], truth[c], within) << front << " " << back << " channel " << c;
    }
}

TEST(PreIntegratedTable, EqualsThinLayers) {
  expectBruteForce(bent(), {-500, 1300}, 1, 17, 3000, 1e-5);
  expectBruteForce(bent(), {-500, 1300}, 8, 11, 6000, 1e-5);
  expectBruteForce(bent(), {-1000, 3000}, 0.1, 7, 3000, 1e-5);  // many knots between two entries
}

// Thin layers are themselves wrong by one layer at a step.
TEST(PreIntegratedTable, EqualsThinLayersAcrossSteps) {
  expectBruteForce(stepped(), {-10, 110}, 1, 13, 20000, 2e-4);
  expectBruteForce(stepped(), {-10, 110}, 4, 7, 40000, 4e-4);
}

TEST(PreIntegratedTable, F4OpacitiesOfZeroOneAndNearlyOneGiveNumbers) {
  expectBruteForce(extreme(), {-10, 110}, 1, 9, 20000, 1e-3);
  for (const double step : {1e-6, 1.0, 1e6}) {
    const auto t = makePreIntegratedTable(extreme(), {0, 100}, step, 101);
    ASSERT_TRUE(t);
    for (const float x : t->rgba) ASSERT_TRUE(x >= 0 && x <= 1);
    EXPECT_EQ(entry(*t, 50, 50)[3], 1);  // opaque
    EXPECT_EQ(entry(*t, 50, 80)[3], 1);  // begins opaque
    EXPECT_NEAR(entry(*t, 50, 80)[0], 0.5, 1e-6);
    EXPECT_EQ(entry(*t, 0, 0)[3], 0);
  }
}

TEST(PreIntegratedTable, ConstantMediumIsExponential) {
  const TransferFunction f{{{0, {1, .5, .25}}}, {{0, .3}}, 2};
  const auto t = makePreIntegratedTable(f, {0, 1}, 3, 9);
  ASSERT_TRUE(t);
  const double opacity = 1 - std::pow(0.7, 1.5);
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) {
      EXPECT_NEAR(entry(*t, i, j)[3], opacity, 1e-7);
      EXPECT_NEAR(entry(*t, i, j)[1], 0.5 * opacity, 1e-7);
    }
}

TEST(PreIntegratedTable, BitEqualForAnyThreads) {
  const int before = threads();
  std::vector<float> first;
  for (int n : {1, 2, 3}) {
    setThreads(n);
    const auto t = makePreIntegratedTable(bent(), {-500, 1300}, 0.45, 128);
    ASSERT_TRUE(t);
    if (first.empty()) first = t->rgba;
    EXPECT_EQ(first, t->rgba);
  }
  setThreads(before);
}

TEST(PreIntegratedTable, TenThousandPoints) {
  TransferFunction f{{{0, {0, 0, 0}}, {1, {1, 1, 1}}}, {}, 1};
  for (int n = 0; n < 10000; ++n) f.opacities.push_back({n / 9999.0, n % 2 * 0.1});
  const auto t = makePreIntegratedTable(f, {0, 1}, 1, 33);
  ASSERT_TRUE(t);
  // The mean of -ln(1 - a) over [0, 0.1], all along.
  const double depth = 1 - (0.9 * std::log(0.9) + 0.1) / 0.1 - 1 + 2 * (0.9 * std::log(0.9) + 0.1) / 0.1;
  EXPECT_NEAR(entry(*t, 0, 32)[3], 1 - std::exp(-depth), 1e-4);
}

TEST(TransferTable, EntriesAreTheFunctionOverOneStep) {
  const auto t = makeTransferTable(bent(), {-500, 1300}, 0.45, false, 1001);
  ASSERT_TRUE(t);
  const auto linear = makeTransferTable(bent(), {-500, 1300}, 3, true, 1001);
  ASSERT_TRUE(linear);
  for (int n = 0; n < 1001; ++n) {
    const double a = opacityAt(bent(), t->valueOf(n));
    EXPECT_NEAR(t->rgba[4 * std::size_t(n) + 3], 1 - std::pow(1 - a, 0.45), 1e-7);
    EXPECT_NEAR(linear->rgba[4 * std::size_t(n) + 3], std::min(1.0, 3 * a), 1e-7);
    EXPECT_NEAR(t->rgba[4 * std::size_t(n)], colourAt(bent(), t->valueOf(n)).x, 1e-7);
  }
}

TEST(TransferTable, RangeIsWhereTheFunctionBends) {
  const Volume::Range inside = transferTableRange(bent(), {-1024, 30000});
  EXPECT_LT(inside.min, -400);
  EXPECT_GT(inside.min, -410);
  EXPECT_GT(inside.max, 1200);
  EXPECT_LT(inside.max, 1210);
  const Volume::Range narrow = transferTableRange(bent(), {0, 100});
  EXPECT_EQ(narrow.min, 0);
  EXPECT_EQ(narrow.max, 100);
  for (const Volume::Range& values : {Volume::Range{5, 5}, Volume::Range{2000, 2000},
                                      Volume::Range{2000, 9000}, Volume::Range{-1e30, -1e30}}) {
    const Volume::Range r = transferTableRange(bent(), values);
    EXPECT_LT(r.min, r.max);
    EXPECT_TRUE(makeTransferTable(bent(), r, 1, false));
  }
}

// What holds beyond the first and the last entry is what holds beyond the knots, also where these are steps.
TEST(TransferTable, OuterEntriesHold) {
  TransferFunction f{{{0, {1, 0, 0}}, {0, {0, 1, 0}}, {10, {0, 0, 1}}, {10, {1, 1, 1}}}, {{5, .5}}, 1};
  const auto t = makeTransferTable(f, transferTableRange(f, {-100, 100}), 1, false);
  ASSERT_TRUE(t);
  EXPECT_EQ(t->rgba[0], 1);
  EXPECT_EQ(t->rgba[1], 0);
  EXPECT_EQ(t->rgba[t->rgba.size() - 4], 1);
  EXPECT_EQ(t->rgba[t->rgba.size() - 3], 1);
}

TEST(TransferTable, RefusesWhatIsNoTable) {
  EXPECT_EQ(makeTransferTable(bent(), {1, 1}, 1, false).error().code, ErrorCode::Internal);
  EXPECT_EQ(makeTransferTable(bent(), {0, 1}, 0, false).error().code, ErrorCode::Internal);
  EXPECT_EQ(makeTransferTable(bent(), {0, 1}, NAN, false).error().code, ErrorCode::Internal);
  EXPECT_EQ(makeTransferTable(bent(), {0, 1}, 1, false, 1).error().code, ErrorCode::Internal);
  EXPECT_EQ(makePreIntegratedTable(bent(), {0, 1}, 1, 4096).error().code, ErrorCode::Internal);
  EXPECT_EQ(makePreIntegratedTable({}, {0, 1}, 1).error().code, ErrorCode::SceneInvalid);
}

}  // namespace
}  // namespace vernier
