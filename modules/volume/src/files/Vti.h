// SPDX-License-Identifier: GPL-3.0-or-later
// VTK XML image data (.vti). Read by own code over expat: VTK's reader allocates what a file declares and
// prints to the terminal, and brings OpenGL libraries along.
#pragma once
#include <string_view>

#include "files/LoadVoxels.h"

namespace vernier {

bool looksLikeVti(std::string_view text);
Result<ParsedVolume> parseVti(const FileRecord& file, const InputFilePtr& input);

// How a data array is stored.
struct VtkArray {
  std::uint64_t offset = 0;  // of its first byte or character in the file
  bool base64 = false, compressed = false, bigEndian = false;
  std::size_t wordBytes = 4;  // of the numbers in its header: 4 or 8
  std::uint64_t bytes = 0;    // of the unpacked array, as the extent asks
};
// The unpacked array. FileDamaged where its own header says something else than the extent.
std::unique_ptr<ByteStream> vtkStream(InputFilePtr, const VtkArray&);

}  // namespace vernier
