// SPDX-License-Identifier: GPL-3.0-or-later
// The surface files among what was opened, with their facts, for `vernier info`.
#pragma once
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "vernier/study/Load.h"
#include "vernier/volume/SurfaceFile.h"

namespace vernier {

struct SurfaceRecord {
  std::string shown;           // as FileRecord::shown
  std::optional<Error> error;  // then nothing of the rest holds
  SurfaceFile file;            // without its mesh: facts and findings are all that is kept
  MeshFacts facts;
  MeshPoint lowest, highest;
  std::uint64_t vertices = 0;
};

// Reads all files of the set whose name is a surface's, one after the other. A file that cannot be read is a
// record with its error; Cancelled ends the list early.
std::vector<SurfaceRecord> surfacesOf(const StudySet&, MemoryBudget*, std::stop_token);

const SurfaceRecord* surfaceNamed(const std::vector<SurfaceRecord>&, const std::string& shown);

}  // namespace vernier
