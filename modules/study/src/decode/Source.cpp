// SPDX-License-Identifier: GPL-3.0-or-later
#include "decode/Source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "vernier/study/Archive.h"

namespace vernier::study {
namespace {
// Most headers of classic objects fit; what does not is read in further windows.
constexpr std::size_t kWindowBytes = 16 << 10;
}  // namespace

bool SpanSource::read(std::uint64_t offset, std::span<std::byte> to) {
  if (!inside(offset, to.size())) return false;
  if (!to.empty()) std::memcpy(to.data(), bytes_.data() + offset, to.size());
  return true;
}

std::span<const std::byte> SpanSource::view(std::uint64_t offset, std::uint64_t n, std::vector<std::byte>&) {
  return inside(offset, n) ? bytes_.subspan(offset, n) : std::span<const std::byte>{};
}

Result<void> FileSource::open(const FileRecord& file) {
  close();
  if (file.archive) {
    auto whole = file.archive->whole(file.entry);
    if (!whole) return whole.error();
    unpacked_ = std::move(*whole);
    size_ = unpacked_->size();
    return {};
  }
  // O_NONBLOCK: opening a pipe must not wait for its other end.
  fd_ = ::open(file.path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd_ < 0)
    return makeError(ErrorCode::FileNotFound,
                     std::string("The file cannot be opened (") + std::strerror(errno) +
                         "); check that it is still there and that you may read it.",
                     file.shown);
  struct stat info {};
  if (::fstat(fd_, &info) != 0 || !S_ISREG(info.st_mode)) {
    close();
    return makeError(ErrorCode::NotAFile, "The path is not a regular file; name a DICOM file.", file.shown);
  }
  size_ = static_cast<std::uint64_t>(info.st_size);
  return {};
}

void FileSource::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
  unpacked_.reset();
  size_ = windowStart_ = windowBytes_ = 0;
}

bool FileSource::readWhole(std::uint64_t offset, std::span<std::byte> to) {
  while (!to.empty()) {
    const ssize_t n = ::pread(fd_, to.data(), to.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    offset += static_cast<std::uint64_t>(n);
    to = to.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

bool FileSource::read(std::uint64_t offset, std::span<std::byte> to) {
  if ((fd_ < 0 && !unpacked_) || !inside(offset, to.size())) return false;
  if (to.empty()) return true;
  if (unpacked_) {
    std::memcpy(to.data(), unpacked_->data() + offset, to.size());
    return true;
  }
  if (to.size() > kWindowBytes / 4) return readWhole(offset, to);
  const bool inWindow = offset >= windowStart_ && offset + to.size() <= windowStart_ + windowBytes_;
  if (!inWindow) {
    window_.resize(kWindowBytes);
    windowBytes_ = 0;
    const std::uint64_t n = std::min<std::uint64_t>(kWindowBytes, size_ - offset);
    if (!readWhole(offset, std::span(window_).first(n))) return false;
    windowStart_ = offset;
    windowBytes_ = n;
  }
  std::memcpy(to.data(), window_.data() + (offset - windowStart_), to.size());
  return true;
}

std::span<const std::byte> FileSource::view(std::uint64_t offset, std::uint64_t n,
                                            std::vector<std::byte>& scratch) {
  if (!inside(offset, n)) return {};
  if (unpacked_) return std::span(*unpacked_).subspan(offset, n);
  scratch.resize(n);
  return read(offset, scratch) ? std::span<const std::byte>(scratch) : std::span<const std::byte>{};
}

}  // namespace vernier::study
