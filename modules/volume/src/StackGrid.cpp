// SPDX-License-Identifier: GPL-3.0-or-later
#include "StackGrid.h"

#include <algorithm>

namespace vernier {

GridGeometry withoutSlices(const GridGeometry& g, const std::vector<std::size_t>& kept) {
  if (kept.size() == static_cast<std::size_t>(g.slices)) return g;
  GridGeometry out = g;
  out.slices = static_cast<std::int64_t>(kept.size());
  const bool oneRun = kept.back() - kept.front() + 1 == kept.size();
  if (g.even() && oneRun) {
    out.patientFromVoxel.translation =
        (g.patientFromVoxel * VoxelPoint(0, 0, static_cast<double>(kept.front()))).p;
    return out;
  }
  out.sliceOrigin_vox.clear();
  out.gapAfter.clear();
  for (std::size_t n = 0; n < kept.size(); ++n) {
    const std::size_t s = kept[n];
    out.sliceOrigin_vox.push_back(g.even() ? glm::dvec3(0, 0, static_cast<double>(s)) : g.sliceOrigin_vox[s]);
    if (n + 1 == kept.size()) break;
    const bool wasGap =
        std::binary_search(g.gapAfter.begin(), g.gapAfter.end(), static_cast<std::int64_t>(s));
    if (wasGap || kept[n + 1] != s + 1) out.gapAfter.push_back(static_cast<std::int64_t>(n));
  }
  return out;
}

}  // namespace vernier
