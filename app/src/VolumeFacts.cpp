// SPDX-License-Identifier: GPL-3.0-or-later
#include "VolumeFacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Sha256.h"

namespace vernier {

Result<VolumeFacts> volumeFacts(const FileRecord& file) {
  const auto read = readVolumeFile(file);
  if (!read) return read.error();
  const Volume& v = **read;
  VolumeFacts facts;
  Sha256 sha;
  sha.add(v.data(), v.bytes());
  facts.sha256 = sha.hex();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const GridGeometry& g = v.grid();
  for (std::int64_t k = 0; k < g.slices; ++k)
    for (std::int64_t j = 0; j < g.rows; ++j)
      for (std::int64_t i = 0; i < g.columns; ++i) {
        const double x = v.stored(i, j, k);
        if (std::isnan(x)) continue;
        low = std::min(low, x);
        high = std::max(high, x);
        facts.storedSum += x;
      }
  if (low <= high) facts.storedMin = low, facts.storedMax = high;
  return facts;
}

}  // namespace vernier
