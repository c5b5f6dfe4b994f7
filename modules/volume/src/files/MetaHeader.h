// SPDX-License-Identifier: GPL-3.0-or-later
// The header of a MetaImage file as plain data. Parsed by own checked code: the reader that ships with
// VTK 9.1 was tried first and does not return on a header with "NDims = -5", and it prints to the terminal.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "files/LoadVoxels.h"
#include "vernier/base/Result.h"

namespace vernier {

struct MetaHeader {
  std::array<std::int64_t, 3> size{1, 1, 1};
  std::array<double, 3> spacing_mm{1, 1, 1};
  std::array<double, 3> offset_mm{0, 0, 0};
  // Direction of the column, row and slice axis, one after the other: numbers 3a..3a+2 of TransformMatrix are
  // the direction cosines of axis a (ITK's MetaImageIO reads them so).
  std::array<glm::dvec3, 3> direction{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
  FileType type = FileType::I16;
  std::int64_t channels = 1;
  bool bigEndian = false, compressed = false;
  std::int64_t headerSize = 0;  // bytes to skip in a separate data file; -1: the data stands at its end
  double slope = 1, intercept = 0;
  std::string modality = "OT";
  std::string dataFile;          // "LOCAL": in this file, at dataOffset
  std::uint64_t dataOffset = 0;  // first byte after the header
};

inline constexpr std::size_t kMaxMetaHeaderBytes = 64 * 1024;

// `text` holds the first bytes of the file (at most kMaxMetaHeaderBytes). FormatUnknown when it is no
// MetaImage header, FileDamaged when it contradicts itself, NotBuiltYet for what is valid but not read,
// GeometryRefused for impossible spacing, each with its sentence.
Result<MetaHeader> parseMetaHeader(std::string_view text, const std::string& where);

// The same as a volume, its data file found beside the header.
Result<ParsedVolume> parseMetaImage(const FileRecord& file, std::string_view text);

}  // namespace vernier
