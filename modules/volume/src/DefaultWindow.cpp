// SPDX-License-Identifier: GPL-3.0-or-later
#include "Percentile.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Voi.h"

namespace vernier {

VoiWindow automaticWindow(const Volume& v) {
  if (v.isColour()) return {127.5, 255, VoiFunction::LinearExact, "colours"};
  const VolumeInfo& info = v.info();
  const std::size_t perSlice = static_cast<std::size_t>(info.grid.columns * info.grid.rows);
  std::vector<SliceValues> slices;
  for (std::int64_t k = 0; k < info.grid.slices; ++k)
    slices.push_back(
        {v.data() + static_cast<std::size_t>(k) * perSlice * bytesOf(info.type), perSlice, v.rescaleOf(k)});
  const double least = leastWidth(info.type, info.rescale.front());
  // Where the tissue-range rule leaves nothing (an image of padding value only), it is no rule.
  if (info.windowNoData)
    if (const auto range = percentiles1And99(info.type, slices, info.windowNoData))
      return windowOver(range, least);
  return windowOver(percentiles1And99(info.type, slices, info.noData), least);
}

VoiWindow defaultWindow(const Volume& v) {
  for (const VoiWindow& w : v.info().windows)
    if (usableWindow(w)) return normalised(w);
  return automaticWindow(v);
}

}  // namespace vernier
