// SPDX-License-Identifier: GPL-3.0-or-later
// Lossy compression blurs the padding around a CT's field of view, so that its voxels no longer equal the
// padding value. No tissue and no air lies below -1024 HU; voxels below that which hang together with the
// slice's border are padding.
#pragma once
#include <cstdint>

#include "vernier/volume/Volume.h"

namespace vernier {

inline constexpr double kLeastTissue_hu = -1024;

// The padding of a CT that declares none: the lowest value of its type, which lies below every tissue.
NoDataRange blurredPaddingOf(VoxelType);

// Whether the rule applies: lossy, and in Hounsfield units by a rising slope.
inline bool mayBlurPadding(const Instance& i, const FrameAttributes& f) {
  return i.lossy && f.unit == "HU" && !i.modalityLut && !f.rescaleInvalid && f.rescale.slope > 0;
}
inline double leastTissue_stored(const ModalityRescale& r) {
  return (kLeastTissue_hu - r.intercept) / r.slope;
}

// Sets those voxels of one slice to `paddingValue` and returns how many were changed. The fill starts at the
// slice's border and walks over 4 neighbours through voxels that are padding already or lie below
// `threshold`, both in stored values.
std::uint64_t markBlurredPadding(VoxelType, std::byte* slice, std::int64_t columns, std::int64_t rows,
                                 const NoDataRange& padding, double threshold, double paddingValue);

}  // namespace vernier
