// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/quality/OrderStatistic.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vernier/base/Random.h"

namespace vernier::quality {

double binomialAtMost(std::size_t k, std::size_t n, double p) {
  if (k >= n || p <= 0) return 1;
  if (p >= 1) return 0;
  // Terms by their logarithm, so that (1 - p)^n may be tiny.
  const double trials = static_cast<double>(n);
  double logTerm = trials * std::log1p(-p), sum = 0;
  for (std::size_t i = 0; i <= k; ++i) {
    sum += std::exp(logTerm);
    const double d = static_cast<double>(i);
    logTerm += std::log((trials - d) / (d + 1)) + std::log(p) - std::log1p(-p);
  }
  return std::min(1.0, sum);
}

std::size_t rankForBound(std::size_t n, std::size_t population, double share, double confidence) {
  if (n == 0 || population == 0) return 0;
  const std::size_t bad = std::min(
      population,
      static_cast<std::size_t>(std::floor((1 - share) * static_cast<double>(population) + 1e-9)) + 1);
  if (n >= population) return bad;
  const std::size_t stratum = (population + n - 1) / n;
  const double mean = static_cast<double>(bad) / static_cast<double>(stratum);
  const double p = mean / static_cast<double>(n);
  std::size_t k = 0;
  while (static_cast<double>(k) <= mean - 1 && binomialAtMost(k, n, p) <= 1 - confidence) ++k;
  return k;
}

std::vector<std::size_t> stratifiedSample(std::size_t n, std::size_t population, std::uint64_t seed) {
  std::vector<std::size_t> out;
  if (population <= 4 * n) {
    out.resize(population);
    std::iota(out.begin(), out.end(), std::size_t{0});
    return out;
  }
  // Strata of floor or ceil of population / n, spread evenly.
  out.reserve(n);
  for (std::size_t s = 0; s < n; ++s) {
    const std::size_t begin = s * population / n, end = (s + 1) * population / n;
    out.push_back(begin + randomBits(seed, s) % (end - begin));
  }
  return out;
}

}  // namespace vernier::quality
