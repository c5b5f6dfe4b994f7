// SPDX-License-Identifier: GPL-3.0-or-later
// The statistics behind "99 % within E, 99 % sure": which of the measured differences may be stated as E.
//
// Let M = floor((1 - share) N) + 1 be the number of pixels that must exceed E for the statement to be false.
// The k-th largest difference of the sample lies below all of them only if the sample holds at most k - 1 of
// them. One pixel is drawn from each of n strata of at most m = ceil(N / n) pixels, so their number is a sum
// of independent draws with mean at least M / m, and by Hoeffding (On the distribution of the number of
// successes in independent trials, Annals of Mathematical Statistics 27, 1956, theorem 4) P(at most k - 1) <=
// Binomial(n, M / (m n)) there, for k - 1 below the mean less one. rankForBound is the largest k whose
// probability stays below 1 - confidence.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vernier/base/Api.h"

namespace vernier::quality {

// k >= 1, or 0 when a sample so small bounds nothing at this confidence. n >= population: every pixel was
// tested, and k is exact. n = 1024 of many: 4; n = 459: 1.
VERNIER_API std::size_t rankForBound(std::size_t n, std::size_t population, double share, double confidence);

// Samples without replacement, one of each stratum, in the population's order: positions in [0, population),
// ascending. All of them when population <= 4 n. Seeded; the same whatever the threads.
VERNIER_API std::vector<std::size_t> stratifiedSample(std::size_t n, std::size_t population,
                                                      std::uint64_t seed);

// P(X <= k) for X of the binomial distribution with n trials of probability p.
VERNIER_API double binomialAtMost(std::size_t k, std::size_t n, double p);

}  // namespace vernier::quality
