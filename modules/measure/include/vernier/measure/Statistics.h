// SPDX-License-Identifier: GPL-3.0-or-later
// Statistics of values in double: mean and SD in two passes with the rounding of the sums carried along, so
// that thirty million voxels at a large offset keep nine digits.
#pragma once
#include <span>
#include <vector>

#include "vernier/measure/Measured.h"

namespace vernier::measure {

// Values on a raster, for the correlation of neighbours: NaN = not in the region or no data.
struct Raster {
  std::size_t columns = 0;
  std::vector<double> values;  // whole rows
};

// min, max, mean, sd, median, histogram of what is not NaN; effective = n. n = 0 where there is nothing.
// `step`: the distance of neighbouring possible values (the slope), 0 where there is none; bins are whole
// steps wide.
VERNIER_API Statistics statisticsOf(std::vector<double> values, double step);

// How many independent values a region holds: n over the product of the correlation lengths along rows and
// columns, each 1 + 2 sum of the autocorrelation up to its first zero (K. J. Friston et al., Statistical
// Parametric Mapping, 1995, take the same view of smooth fields). From 1 to n.
VERNIER_API double effectiveCount(const Raster&, double mean, std::uint64_t n);

}  // namespace vernier::measure
