// SPDX-License-Identifier: GPL-3.0-or-later
// Files that are read in pieces, wherever they are. A file on disk is never mapped: one that shrinks under a
// map kills the process.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "vernier/study/Model.h"

namespace vernier {

// An open file. Thread-safe.
class InputFile {
 public:
  virtual ~InputFile() = default;
  virtual std::uint64_t size() const = 0;  // when it was opened
  // Fills `to` from `offset` on; false when not all of it is there or reading fails.
  virtual bool read(std::uint64_t offset, std::span<std::byte> to) const = 0;
};

// A record for a file that the user names: path, shown (its last part) and size. FileNotFound, NotAFile.
VERNIER_API Result<FileRecord> recordOf(const std::string& path);

// FileNotFound or NotAFile (a folder, device, pipe or socket is not opened), with FileRecord::shown as
// `where`. An entry of an archive is unpacked to memory as far as somebody reads.
VERNIER_API Result<std::shared_ptr<const InputFile>> openInput(const FileRecord&);

// The record of the file that a header names, which must lie in or below the header's own folder: absolute
// names,
// ".." and links that lead out of it are FileDamaged. The file need not be there.
VERNIER_API Result<FileRecord> besideFile(const FileRecord& header, const std::string& name);

}  // namespace vernier
