// SPDX-License-Identifier: GPL-3.0-or-later
#include "ByteSource.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>

#include "vernier/study/Archive.h"
#include "vernier/study/Limits.h"

namespace vernier {
namespace {

constexpr std::uint64_t kFirstRead = 16 << 10;

class FileSource final : public ByteSource {
 public:
  FileSource(int fd, std::uint64_t size) : fd_(fd), size_(size) {}
  ~FileSource() override { ::close(fd_); }
  std::uint64_t limit() const override { return size_; }

 protected:
  bool grow(std::uint64_t end) override {
    const std::uint64_t have = bytes_.size();
    const std::uint64_t want = std::min(size_, std::max({end, kFirstRead, have * 4}));
    bytes_.resize(want);
    std::uint64_t at = have;
    while (at < want) {
      const ssize_t n = ::pread(fd_, bytes_.data() + at, want - at, static_cast<off_t>(at));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0)
        failure_ = makeError(ErrorCode::FileNotFound, "Reading the file failed; check the disk or network.");
      if (n <= 0) break;  // shorter than it was when it was opened
      at += static_cast<std::uint64_t>(n);
    }
    bytes_.resize(at);
    if (at < want) size_ = at;
    return at >= end;
  }

 private:
  int fd_;
  std::uint64_t size_;
};

class EntrySource final : public ByteSource {
 public:
  EntrySource(std::unique_ptr<Archive::Reader> reader, std::uint64_t size)
      : reader_(std::move(reader)), size_(size) {}
  std::uint64_t limit() const override { return size_; }

 protected:
  bool grow(std::uint64_t end) override {
    const std::size_t have = bytes_.size();
    bytes_.resize(std::min(size_, std::max({end, kFirstRead, have * 4})));
    const auto n = reader_->read(std::span(bytes_).subspan(have));
    bytes_.resize(have + (n ? *n : 0));
    if (!n) {
      failure_ = n.error();
      size_ = have;
    }
    return bytes_.size() >= end;
  }

 private:
  std::unique_ptr<Archive::Reader> reader_;
  std::uint64_t size_;
};

class MemorySource final : public ByteSource {
 public:
  explicit MemorySource(std::span<const std::byte> b) { view_ = b; }
  std::uint64_t limit() const override { return view_.size(); }
  std::vector<std::byte> take() override { return {view_.begin(), view_.end()}; }

 protected:
  bool grow(std::uint64_t) override { return false; }
};

class InflateSource final : public ByteSource {
 public:
  InflateSource(ByteSource& packed, std::uint64_t offset) : packed_(packed), at_(offset), first_(offset) {
    ready_ = inflateInit2(&stream_, -MAX_WBITS) == Z_OK;
  }
  ~InflateSource() override {
    if (ready_) inflateEnd(&stream_);
  }
  std::uint64_t limit() const override { return limits::kMaxInflatedBytes; }

 protected:
  bool grow(std::uint64_t end) override {
    constexpr std::size_t kChunk = 64 << 10;
    while (ready_ && !done_ && bytes_.size() < end) {
      if (!packed_.ensure(at_ + 1)) break;
      const auto input = packed_.bytes().subspan(at_);
      stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(input.data()));
      stream_.avail_in = static_cast<uInt>(std::min<std::size_t>(input.size(), 1u << 30));
      const std::size_t have = bytes_.size();
      bytes_.resize(have + kChunk);
      stream_.next_out = reinterpret_cast<Bytef*>(bytes_.data() + have);
      stream_.avail_out = kChunk;
      const uInt before = stream_.avail_in;
      const int rc = inflate(&stream_, Z_NO_FLUSH);
      at_ += before - stream_.avail_in;
      bytes_.resize(have + kChunk - stream_.avail_out);
      done_ = rc == Z_STREAM_END;
      if (rc != Z_OK && rc != Z_STREAM_END) {
        failure_ =
            makeError(ErrorCode::FileDamaged, "The deflated data set is damaged; ask for the file again.");
        break;
      }
      if (bytes_.size() > std::max(limits::kAlwaysInflatedBytes, (at_ - first_) * limits::kMaxInflateRatio)) {
        failure_ =
            makeError(ErrorCode::LimitExceeded, "The deflated data set grows more than " +
                                                    std::to_string(limits::kMaxInflateRatio) +
                                                    " times, which no image does; the file is refused.");
        break;
      }
    }
    return bytes_.size() >= end;
  }

 private:
  ByteSource& packed_;
  std::uint64_t at_, first_;
  z_stream stream_{};
  bool ready_ = false, done_ = false;
};

}  // namespace

Result<std::unique_ptr<ByteSource>> openFileSource(const std::string& path) {
  struct stat before {};
  if (::stat(path.c_str(), &before) != 0)
    return makeError(ErrorCode::FileNotFound, "The file cannot be found; check its name.");
  if (!S_ISREG(before.st_mode))
    return makeError(ErrorCode::NotAFile,
                     "This is a folder, device, pipe or socket, not a file; it was not opened.");
  // O_NONBLOCK: should the name have become a pipe since, opening it must not wait.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd < 0) return makeError(ErrorCode::FileNotFound, "The file cannot be read; check its permissions.");
  struct stat now {};
  if (::fstat(fd, &now) != 0 || !S_ISREG(now.st_mode)) {
    ::close(fd);
    return makeError(ErrorCode::NotAFile,
                     "The file was replaced by something else while it was opened; try again.");
  }
  return std::unique_ptr<ByteSource>(
      std::make_unique<FileSource>(fd, static_cast<std::uint64_t>(now.st_size)));
}

Result<std::unique_ptr<ByteSource>> openSource(const FileRecord& file) {
  if (!file.archive) return openFileSource(file.path);
  auto reader = file.archive->reader(file.entry);
  if (!reader) return reader.error();
  return std::unique_ptr<ByteSource>(
      std::make_unique<EntrySource>(std::move(*reader), file.archive->entries()[file.entry].bytes));
}

std::unique_ptr<ByteSource> memorySource(std::span<const std::byte> bytes) {
  return std::make_unique<MemorySource>(bytes);
}

std::unique_ptr<ByteSource> inflateSource(ByteSource& packed, std::uint64_t offset) {
  return std::make_unique<InflateSource>(packed, offset);
}

}  // namespace vernier
