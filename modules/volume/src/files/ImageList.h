// SPDX-License-Identifier: GPL-3.0-or-later
// A text file that names the pictures of a volume, one per line (as the .vrp files of SGI's Volume Rendering
// Primer). Grammar: docs/files.md.
#pragma once
#include <string_view>

#include "files/LoadVoxels.h"

namespace vernier {

inline constexpr std::uint64_t kMaxImageListBytes = 8 << 20;

// Whether the first line that names something names a picture beside the file.
bool looksLikeImageList(const FileRecord& file, std::string_view text);
Result<ParsedVolume> parseImageList(const FileRecord& file, const InputFilePtr& input);

// Places the slices of a list so that all together span this length: BuildOptions::zSpan.
void spanSlices(GridGeometry&, double zSpan);

}  // namespace vernier
