// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes that are read only as far as somebody asks: a file by read(), or the inflated rest of one. What a
// file declares never sizes a buffer; only bytes that are really there do.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/base/Result.h"
#include "vernier/study/Model.h"

namespace vernier {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  // True when bytes [0, end) are at hand afterwards; false when the source ends before or failed (see
  // failure()).
  bool ensure(std::uint64_t end) {
    if (end <= view_.size()) return true;
    if (end > limit()) return false;
    const bool enough = grow(end);
    view_ = bytes_;
    return enough;
  }
  std::span<const std::byte> bytes() const { return view_; }
  // No byte lies at or beyond this offset. The size of a file; for a deflated source the greatest size
  // allowed.
  virtual std::uint64_t limit() const = 0;
  const std::optional<Error>& failure() const { return failure_; }
  virtual std::vector<std::byte> take() {
    view_ = {};
    return std::move(bytes_);
  }

 protected:
  virtual bool grow(std::uint64_t end) = 0;
  std::vector<std::byte> bytes_;     // what grow() adds to
  std::span<const std::byte> view_;  // what is at hand: bytes_, or memory of somebody else
  std::optional<Error> failure_;
};

// Opens a regular file; a device, pipe, socket or folder is refused without being opened for reading.
Result<std::unique_ptr<ByteSource>> openFileSource(const std::string& path);
// The same for a file wherever it is: an entry of an archive is unpacked as far as it is read.
Result<std::unique_ptr<ByteSource>> openSource(const FileRecord&);
// Bytes in memory that outlive the source; take() gives a copy.
std::unique_ptr<ByteSource> memorySource(std::span<const std::byte> bytes);
// The inflated form (raw deflate, PS3.5 A.5) of what follows `offset` in `packed`, which must outlive it.
std::unique_ptr<ByteSource> inflateSource(ByteSource& packed, std::uint64_t offset);

}  // namespace vernier
