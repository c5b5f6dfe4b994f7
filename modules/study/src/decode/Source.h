// SPDX-License-Identifier: GPL-3.0-or-later
// Where the bytes of one DICOM file come from: memory, or an open file read piece by piece with pread (never
// mapped: a file that shrinks under a map kills the process). Every read is checked against the size known at
// the start. Not shared between threads.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "vernier/base/Result.h"
#include "vernier/study/Model.h"

namespace vernier::study {

class Source {
 public:
  virtual ~Source() = default;
  virtual std::uint64_t size() const = 0;
  // Copies [offset, offset + to.size()) into `to`; false when that is not all inside the file or cannot be
  // read.
  virtual bool read(std::uint64_t offset, std::span<std::byte> to) = 0;
  // The same bytes without a copy where they are in memory already, else by way of `scratch`; empty on
  // failure.
  virtual std::span<const std::byte> view(std::uint64_t offset, std::uint64_t n,
                                          std::vector<std::byte>& scratch) = 0;

 protected:
  bool inside(std::uint64_t offset, std::uint64_t n) const {
    return offset <= size() && n <= size() - offset;
  }
};

class SpanSource final : public Source {
 public:
  explicit SpanSource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_.size(); }
  bool read(std::uint64_t offset, std::span<std::byte> to) override;
  std::span<const std::byte> view(std::uint64_t offset, std::uint64_t n,
                                  std::vector<std::byte>& scratch) override;

 private:
  std::span<const std::byte> bytes_;
};

// Small reads (headers) go through a window that is kept between files; large ones straight to their
// destination.
class FileSource final : public Source {
 public:
  FileSource() = default;
  ~FileSource() override { close(); }
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  // Errors: FileNotFound, NotAFile; FileDamaged for an entry of an archive, which is unpacked whole to memory
  // (and shared by all sources that hold it).
  Result<void> open(const FileRecord& file);
  void close();
  std::uint64_t size() const override { return size_; }
  bool read(std::uint64_t offset, std::span<std::byte> to) override;
  std::span<const std::byte> view(std::uint64_t offset, std::uint64_t n,
                                  std::vector<std::byte>& scratch) override;

 private:
  bool readWhole(std::uint64_t offset, std::span<std::byte> to);

  int fd_ = -1;
  std::uint64_t size_ = 0;
  std::vector<std::byte> window_;
  std::uint64_t windowStart_ = 0, windowBytes_ = 0;
  std::shared_ptr<const std::vector<std::byte>> unpacked_;
};

}  // namespace vernier::study
