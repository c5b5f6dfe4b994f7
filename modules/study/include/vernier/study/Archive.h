// SPDX-License-Identifier: GPL-3.0-or-later
// A ZIP archive whose entries are read without being written anywhere. What an entry says of itself is
// checked by its actual bytes; an entry that is refused carries one sentence and the others stay readable.
// Limits: Limits.h.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"

namespace vernier {

class InputFile;

// Whether a file with these first bytes is a ZIP archive.
VERNIER_API bool looksLikeArchive(std::span<const std::byte> head);

// Thread-safe.
class VERNIER_API Archive {
 public:
  struct Entry {
    std::string name;            // path in the archive, "/" between its parts; UTF-8
    std::uint64_t bytes = 0;     // unpacked, as declared; an entry never delivers more
    std::optional<Error> error;  // why it is not read
  };
  // One unpacked entry, from its beginning on.
  class Reader {
   public:
    virtual ~Reader() = default;
    // Fills `to` from the front; fewer bytes only at the end. FileDamaged when the data are damaged, do not
    // have the checksum that they should, or are fewer or more than declared.
    virtual Result<std::size_t> read(std::span<std::byte> to) = 0;
  };

  // FileDamaged when the directory of the archive cannot be read; LimitExceeded when it has too many entries.
  // `shown`: what errors call it.
  static Result<std::shared_ptr<const Archive>> open(std::shared_ptr<const InputFile> file,
                                                     const std::string& shown);
  virtual ~Archive();
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  // Files only, in the archive's order.
  const std::vector<Entry>& entries() const { return entries_; }
  virtual Result<std::unique_ptr<Reader>> reader(std::size_t entry) const = 0;
  // All of an entry; several that ask at a time share it.
  Result<std::shared_ptr<const std::vector<std::byte>>> whole(std::size_t entry) const;

 protected:
  Archive();
  std::vector<Entry> entries_;

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace vernier
