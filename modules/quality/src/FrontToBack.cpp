// SPDX-License-Identifier: GPL-3.0-or-later
#include "FrontToBack.h"

#include <numbers>

namespace vernier::quality {
namespace {

// P_0 .. P_N at x in [-1, 1].
template <std::size_t N>
std::array<double, N + 1> legendre(double x) {
  std::array<double, N + 1> p{1, x};
  for (std::size_t n = 1; n < N; ++n) {
    const double k = static_cast<double>(n);
    p[n + 1] = ((2 * k + 1) * x * p[n] - k * p[n - 1]) / (k + 1);
  }
  return p;
}

// The polynomial through the places is, by discrete orthogonality, sum of (2m + 1) P_m with the weighted sums
// of the values times P_m; and P_m integrates to (P_m+1 - P_m-1) / (2m + 1).
template <std::size_t N>
GaussRule<N> ruleOf() {
  GaussRule<N> rule;
  constexpr double n = N;
  for (std::size_t i = 0; i < N; ++i) {
    double x = -std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (n + 0.5));
    double slope = 1;
    for (int step = 0; step < 20; ++step) {
      const auto p = legendre<N>(x);
      slope = n * (x * p[N] - p[N - 1]) / (x * x - 1);
      x -= p[N] / slope;
    }
    rule.at[i] = 0.5 * (1 + x);
    rule.weight[i] = 1 / ((1 - x * x) * slope * slope);
  }
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) {
      const auto here = legendre<N>(2 * rule.at[i] - 1), there = legendre<N>(2 * rule.at[j] - 1);
      double sum = rule.at[i];
      for (std::size_t m = 1; m < N; ++m) sum += 0.5 * there[m] * (here[m + 1] - here[m - 1]);
      rule.upTo[i][j] = rule.weight[j] * sum;
    }
  return rule;
}

}  // namespace

template <std::size_t N>
const GaussRule<N>& gaussRule() {
  static const GaussRule<N> rule = ruleOf<N>();
  return rule;
}
template const GaussRule<2>& gaussRule<2>();
template const GaussRule<4>& gaussRule<4>();
template const GaussRule<8>& gaussRule<8>();

}  // namespace vernier::quality
