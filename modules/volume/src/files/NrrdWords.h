// SPDX-License-Identifier: GPL-3.0-or-later
// The words of NRRD headers: lines, types, kinds of axes.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "files/LoadVoxels.h"

namespace vernier {

struct NrrdLines {
  std::map<std::string, std::string> fields;  // by lower-case name
  std::size_t end = 0;                        // first byte behind the blank line
  bool closed = false;                        // there was a blank line
};

// "field: value" lines up to a blank line; comments and "key:=value" pairs are passed over. FileDamaged.
Result<NrrdLines> splitNrrdLines(std::string_view text);

// Of a type's name in lower case.
std::optional<FileType> nrrdType(std::string_view name);

// Kinds of an axis (lower case) whose entries are the values of one voxel, and how many each has (0: any
// number).
std::optional<std::int64_t> nrrdValuesPerVoxel(std::string_view kind);

}  // namespace vernier
