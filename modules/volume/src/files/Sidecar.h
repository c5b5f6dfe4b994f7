// SPDX-License-Identifier: GPL-3.0-or-later
// Raw voxels with a JSON file beside them that says what they are: schema "vernier-raw/1" (docs/files.md).
#pragma once
#include <string_view>

#include "files/LoadVoxels.h"

namespace vernier {

inline constexpr std::size_t kMaxSidecarBytes = 64 * 1024;

// Whether a text is such a file, or that of another program which parseSidecar refuses by name.
bool looksLikeSidecar(std::string_view text);
Result<ParsedVolume> parseSidecar(const FileRecord& file, std::string_view text);

}  // namespace vernier
