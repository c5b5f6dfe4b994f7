// SPDX-License-Identifier: GPL-3.0-or-later
// Facts of the voxels of a volume file, in their type in memory.
#pragma once
#include <string>

#include "vernier/volume/VolumeFile.h"

namespace vernier {

struct VolumeFacts {
  struct Channel {
    double min = 0, max = 0, sum = 0;  // of stored values, without NaN
  };
  std::string sha256;             // of the voxels, columns fastest, little endian; colours interleaved
  std::vector<Channel> channels;  // one; of colours red, green, blue and, where there is one, alpha
  std::vector<Finding> findings;  // those of the header, and what reading the voxels found
};
Result<VolumeFacts> volumeFacts(const FileRecord&);

}  // namespace vernier
