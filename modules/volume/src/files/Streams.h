// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of voxels one after the other, however a file packs them. Not shared between threads.
#pragma once
#include <memory>

#include "vernier/study/Files.h"

namespace vernier {

class ByteStream {
 public:
  virtual ~ByteStream() = default;
  // Fills `to` from the front; fewer bytes only where the data ends. FileDamaged when it cannot be unpacked.
  virtual Result<std::size_t> read(std::span<std::byte> to) = 0;
  // After the last voxel: what follows, up to a checksum, must be sound.
  virtual Result<void> finish() { return {}; }
};

using InputFilePtr = std::shared_ptr<const InputFile>;

std::unique_ptr<ByteStream> rawStream(InputFilePtr, std::uint64_t offset);
// zlib or gzip from `offset` on; several gzip members count as one.
std::unique_ptr<ByteStream> gzipStream(InputFilePtr, std::uint64_t offset);

std::unique_ptr<ByteStream> bzip2Stream(InputFilePtr, std::uint64_t offset);

// Takes exactly n bytes; PixelDataShort when fewer are there.
Result<void> readExactly(ByteStream&, std::span<std::byte> to);
Result<void> skipExactly(ByteStream&, std::uint64_t n);

}  // namespace vernier
