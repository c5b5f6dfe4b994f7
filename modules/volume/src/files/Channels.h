// SPDX-License-Identifier: GPL-3.0-or-later
// Files of several values per voxel: 3 are red, green and blue, 4 the same and alpha (opacity, the colours
// not multiplied by it), each of 8 bits. Everything else that stands several times in a voxel is refused.
#pragma once
#include <vector>

#include "files/LoadVoxels.h"

namespace vernier {

// The channels that a header states, once its type is known. More than one: the volume is one of colours.
// NotBuiltYet where they are no colours that are read.
Result<void> setChannels(ParsedVolume&, std::int64_t channels);

// Interleaved samples of some voxels into the planes, from voxel `at` on.
void spreadChannels(std::span<const std::byte> interleaved, std::vector<Buffer>& planes, std::uint64_t at);

// What the fourth plane means for pictures. A plane that is 0 everywhere would hide the volume, which no
// writer wants: it is dropped, with a warning. Nothing happens to 3 planes.
void judgeAlpha(std::vector<Buffer>& planes, std::vector<Finding>&);

}  // namespace vernier
