// SPDX-License-Identifier: GPL-3.0-or-later
// Facts of the voxels of a volume file, in their type in memory.
#pragma once
#include <string>

#include "vernier/volume/VolumeFile.h"

namespace vernier {

struct VolumeFacts {
  std::string sha256;                                  // of the voxels, columns fastest, little endian
  double storedMin = 0, storedMax = 0, storedSum = 0;  // without NaN
};
Result<VolumeFacts> volumeFacts(const FileRecord&);

}  // namespace vernier
