// SPDX-License-Identifier: GPL-3.0-or-later
#include "VolumeFacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Sha256.h"

namespace vernier {

namespace {

VolumeFacts::Channel channelFacts(const Volume& v) {
  VolumeFacts::Channel c;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const GridGeometry& g = v.grid();
  for (std::int64_t k = 0; k < g.slices; ++k)
    for (std::int64_t j = 0; j < g.rows; ++j)
      for (std::int64_t i = 0; i < g.columns; ++i) {
        const double x = v.stored(i, j, k);
        if (std::isnan(x)) continue;
        low = std::min(low, x);
        high = std::max(high, x);
        c.sum += x;
      }
  if (low <= high) c.min = low, c.max = high;
  return c;
}

std::string shaOfColours(const Volume& v) {
  Sha256 sha;
  const GridGeometry& g = v.grid();
  const auto channels = static_cast<std::size_t>(v.info().channels);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(g.columns) * channels);
  for (std::int64_t k = 0; k < g.slices; ++k)
    for (std::int64_t j = 0; j < g.rows; ++j) {
      for (std::int64_t i = 0; i < g.columns; ++i) {
        const auto rgba = v.rgba(i, j, k);
        std::copy_n(rgba.begin(), channels, row.begin() + i * static_cast<std::int64_t>(channels));
      }
      sha.add(row.data(), row.size());
    }
  return sha.hex();
}

}  // namespace

Result<VolumeFacts> volumeFacts(const FileRecord& file) {
  const auto read = readVolumeFile(file);
  if (!read) return read.error();
  const Volume& v = **read;
  VolumeFacts facts;
  facts.findings = v.info().findings;
  if (v.isColour()) {
    facts.sha256 = shaOfColours(v);
    for (int c = 0; c < v.info().channels; ++c) facts.channels.push_back(channelFacts(v.channel(c)));
    return facts;
  }
  Sha256 sha;
  sha.add(v.data(), v.bytes());
  facts.sha256 = sha.hex();
  facts.channels.push_back(channelFacts(v));
  return facts;
}

}  // namespace vernier
