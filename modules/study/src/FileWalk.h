// SPDX-License-Identifier: GPL-3.0-or-later
// The files under what the user named, in a fixed order; of an archive that was named itself its entries.
// Nothing else is opened; links are followed only to places inside the folder that was named, each file and
// folder once.
#pragma once
#include <string>
#include <vector>

#include "vernier/study/Model.h"

namespace vernier {

// FileRecords with path, shown and bytes; a device, pipe, socket, outward link or unreadable folder carries
// its error. Fails when a named path does not exist, is no file or folder, or when there are too many files.
// `unpack`: whether archives that are named are opened.
Result<std::vector<FileRecord>> walkFiles(const std::vector<std::string>& paths, bool unpack = true);

}  // namespace vernier
