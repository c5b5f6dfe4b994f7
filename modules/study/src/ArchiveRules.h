// SPDX-License-Identifier: GPL-3.0-or-later
// Which entries of an archive are read: pure rules over what the archive's directory says. The sizes that it
// declares are upper bounds that the reader enforces, so what is refused here cannot be unpacked later.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "vernier/study/Archive.h"

namespace vernier {

struct EntryClaims {
  std::string name;
  std::uint64_t bytes = 0, packedBytes = 0;
  std::uint32_t unixMode = 0;  // 0: made elsewhere
  bool encrypted = false;
  bool readable = true;  // known, and packed in a way that can be unpacked
};

// What the entries so far ask for in all.
class ArchiveSizes {
 public:
  explicit ArchiveSizes(std::uint64_t archiveBytes) : archiveBytes_(archiveBytes) {}
  // An error's sentence when one more entry would go beyond a limit; it is not counted then.
  std::optional<Error> add(std::uint64_t bytes, std::uint64_t packedBytes);

 private:
  std::uint64_t archiveBytes_, bytes_ = 0, packed_ = 0;
};

Result<void> checkEntryCount(std::uint64_t count, const std::string& shown);

// nullopt for folders, which are no files.
std::optional<Archive::Entry> judgeEntry(const EntryClaims&, ArchiveSizes&);

std::string lastPart(const std::string& name);

}  // namespace vernier
