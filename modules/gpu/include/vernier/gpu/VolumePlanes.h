// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a volume as textures, kept in the device's cache: slabs of slices, and single planes across each
// axis. Grey volumes as VolumeTexels.h says, colour volumes as RGBA8 (their TexelCode takes no part). Render
// thread. Errors: OutOfMemory, with the numbers, for a slab beyond what the cache may hold; Cancelled.
#pragma once
#include "vernier/gpu/VolumeTexels.h"

namespace vernier::gpu {

VERNIER_API std::uint64_t bytesOfTexel(const Volume&, const TexelCode&);

// Slices first .. first + count - 1 as a 3-D texture; all of a grey volume's are volumeTexture().
VERNIER_API Result<std::shared_ptr<const Texture>> slabTexture(Device&, const Volume&, const TexelCode&,
                                                               std::int64_t first, std::int64_t count,
                                                               std::stop_token);
// The plane `at` across axis 0, 1 or 2 (columns, rows, slices). Width and height are the extents along the
// other axes in the order x, y, z: (y, z), (x, z) or (x, y).
VERNIER_API Result<std::shared_ptr<const Texture>> planeTexture(Device&, const Volume&, const TexelCode&,
                                                                int axis, std::int64_t at);

}  // namespace vernier::gpu
