// SPDX-License-Identifier: GPL-3.0-or-later
// From what a header says to voxels in memory: one way for all formats. Sizes are checked before memory is
// taken; values are turned to native byte order and, where a Volume has no such type, converted piece by
// piece.
#pragma once
#include <functional>
#include <optional>
#include <stop_token>

#include "files/Streams.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier {

// Type of one value in a file.
enum class FileType { U8, I8, U16, I16, U32, I32, U64, I64, F32, F64 };
std::size_t bytesOf(FileType);
const char* nameOf(FileType);     // "uint8", "float64"
VoxelType voxelTypeOf(FileType);  // what becomes of it in memory

// Text: decimal numbers between blanks and commas. Other: VoxelPlace::open knows.
enum class Packing { Raw, Gzip, Bzip2, Text, Other };

// Where the voxels stand: all slices one after the other, columns fastest.
struct VoxelPlace {
  FileRecord file;
  std::uint64_t offset = 0;  // of the (packed) data in the file
  bool atEnd = false;        // Raw: the data are the last bytes of the file, offset counts from their start
  std::uint64_t skipLines = 0;  // behind offset, before the data are unpacked
  Packing packing = Packing::Raw;
  std::uint64_t skip = 0;  // bytes to pass over once unpacked
  FileType type = FileType::U8;
  bool bigEndian = false;
  // Values per voxel, set by setChannels(): interleaved, or all of one channel before the next.
  int channels = 1;
  bool planar = false;
  // Packing::Other: the unpacked bytes of all voxels, and how many the file can hold at most.
  std::function<std::unique_ptr<ByteStream>(const InputFilePtr&)> open;
  std::uint64_t mostBytes = 0;
};

// A header that was read and found usable. The frame's bytes follow from facts.info.grid and place.type.
struct ParsedVolume {
  VolumeFileFacts facts;
  VoxelPlace place;
};

inline std::uint64_t bytesPerVoxel(const VoxelPlace& p) {
  return bytesOf(p.type) * static_cast<std::uint64_t>(p.channels);
}

// Voxels of `place` as bytes of place.type in the place's byte order, from the start of the data.
std::unique_ptr<ByteStream> openStream(const InputFilePtr&, const VoxelPlace&);
std::unique_ptr<ByteStream> textStream(InputFilePtr, std::uint64_t offset, FileType);

Result<std::shared_ptr<const Volume>> loadVoxels(ParsedVolume, const BuildOptions&, const ProgressFn&,
                                                 std::stop_token);

}  // namespace vernier
