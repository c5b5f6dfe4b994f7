// SPDX-License-Identifier: GPL-3.0-or-later
// NRRD headers (teem's format definition, NRRD0001 to NRRD0006), attached and detached.
#pragma once
#include <string_view>

#include "files/LoadVoxels.h"

namespace vernier {

bool looksLikeNrrd(std::string_view text);

// `text`: the first bytes of the file (at most kMaxNrrdHeaderBytes).
inline constexpr std::size_t kMaxNrrdHeaderBytes = 64 * 1024;
Result<ParsedVolume> parseNrrd(const FileRecord& file, std::string_view text);

}  // namespace vernier
