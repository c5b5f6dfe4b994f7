// SPDX-License-Identifier: GPL-3.0-or-later
// What `vernier info` says of a study: JSON of schema "vernier-info/1" (docs/info.md) or a page of text.
// Lengths mm, positions LPS, spacings row\column as in DICOM. Thread-safe.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "InfoSurfaces.h"
#include "vernier/study/Load.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier {

struct InfoProbe {
  std::string file;  // as FileRecord::shown; empty = every image that has this pixel
  std::uint64_t row = 0, column = 0;
};
struct InfoOptions {
  bool pixels = false;  // decode every image: SHA-256 of stored values, extrema, sum
  std::vector<InfoProbe> probes;
  std::vector<SurfaceRecord> surfaces;  // of the same set
};

std::string infoJson(const StudySet&, const InfoOptions& = {}, const std::vector<VolumeFile>& = {});
std::string infoText(const StudySet&, const std::vector<VolumeFile>& = {},
                     const std::vector<SurfaceRecord>& = {});

}  // namespace vernier
