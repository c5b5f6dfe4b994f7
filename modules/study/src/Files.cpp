// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/study/Files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <vector>

#include "vernier/study/Archive.h"

namespace vernier {
namespace {
namespace fs = std::filesystem;

class DiskFile final : public InputFile {
 public:
  DiskFile(int fd, std::uint64_t size) : fd_(fd), size_(size) {}
  ~DiskFile() override { ::close(fd_); }
  std::uint64_t size() const override { return size_; }
  bool read(std::uint64_t offset, std::span<std::byte> to) const override {
    if (offset > size_ || to.size() > size_ - offset) return false;
    while (!to.empty()) {
      const ssize_t n = ::pread(fd_, to.data(), to.size(), static_cast<off_t>(offset));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      offset += static_cast<std::uint64_t>(n);
      to = to.subspan(static_cast<std::size_t>(n));
    }
    return true;
  }

 private:
  int fd_;
  std::uint64_t size_;
};

// An entry of an archive, unpacked as far as it was read.
class EntryFile final : public InputFile {
 public:
  EntryFile(std::unique_ptr<Archive::Reader> reader, std::uint64_t size)
      : size_(size), reader_(std::move(reader)) {}
  std::uint64_t size() const override { return size_; }
  bool read(std::uint64_t offset, std::span<std::byte> to) const override {
    if (offset > size_ || to.size() > size_ - offset) return false;
    const std::lock_guard lock(mutex_);
    if (!unpack(offset + to.size())) return false;
    if (!to.empty()) std::memcpy(to.data(), bytes_.data() + offset, to.size());
    return true;
  }

 private:
  bool unpack(std::uint64_t end) const {
    constexpr std::uint64_t kFirst = 64 << 10;
    while (bytes_.size() < end) {
      const std::size_t have = bytes_.size();
      bytes_.resize(static_cast<std::size_t>(std::min(size_, std::max({end, have + have / 2, kFirst}))));
      const auto n = reader_->read(std::span(bytes_).subspan(have));
      bytes_.resize(have + (n ? *n : 0));
      if (!n || *n == 0) return false;
    }
    return true;
  }
  std::uint64_t size_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<Archive::Reader> reader_;
  mutable std::vector<std::byte> bytes_;
};

Result<std::shared_ptr<const InputFile>> openEntry(const FileRecord& file) {
  auto reader = file.archive->reader(file.entry);
  if (!reader) return reader.error();
  return std::shared_ptr<const InputFile>(
      std::make_shared<EntryFile>(std::move(*reader), file.archive->entries()[file.entry].bytes));
}

// The entry of that name in the header's folder of the archive.
FileRecord entryBeside(const FileRecord& header, const fs::path& named) {
  const auto& entries = header.archive->entries();
  const std::string wanted =
      (fs::path(entries[header.entry].name).parent_path() / named).lexically_normal().generic_string();
  FileRecord r = header;
  r.shown = named.filename().string();
  const auto it = std::find_if(entries.begin(), entries.end(), [&](const Archive::Entry& e) {
    return fs::path(e.name).lexically_normal().generic_string() == wanted;
  });
  r.entry = static_cast<std::size_t>(it - entries.begin());  // one past the last: opening it says so
  r.bytes = it == entries.end() ? 0 : it->bytes;
  return r;
}

bool inside(const fs::path& folder, const fs::path& target) {
  const auto [f, t] = std::mismatch(folder.begin(), folder.end(), target.begin(), target.end());
  return f == folder.end();
}

Error outside(const FileRecord& header) {
  return makeError(
      ErrorCode::FileDamaged,
      "The header names a data file outside the header's folder, which is refused; put both files "
      "in one folder and name the data file alone.",
      header.shown);
}

}  // namespace

Result<FileRecord> recordOf(const std::string& path) {
  FileRecord r;
  r.path = path;
  r.shown = fs::path(path).filename().string();
  struct stat s {};
  if (::stat(path.c_str(), &s) != 0)
    return makeError(ErrorCode::FileNotFound, "The file does not exist or cannot be read.", r.shown);
  if (!S_ISREG(s.st_mode))
    return makeError(ErrorCode::NotAFile, "This is a folder, device, pipe or socket, not a file.", r.shown);
  r.bytes = static_cast<std::uint64_t>(s.st_size);
  return r;
}

Result<std::shared_ptr<const InputFile>> openInput(const FileRecord& file) {
  if (file.archive) {
    if (file.entry < file.archive->entries().size()) return openEntry(file);
    return makeError(ErrorCode::FileNotFound, "The archive has no such file.", file.shown);
  }
  // O_NONBLOCK: opening a pipe must not wait for its other end.
  const int fd = ::open(file.path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd < 0)
    return makeError(ErrorCode::FileNotFound,
                     "The file cannot be opened; check that it is still there and that you may read it.",
                     file.shown);
  struct stat s {};
  if (::fstat(fd, &s) != 0 || !S_ISREG(s.st_mode)) {
    ::close(fd);
    return makeError(ErrorCode::NotAFile, "This is a folder, device, pipe or socket, not a file.",
                     file.shown);
  }
  return std::shared_ptr<const InputFile>(
      std::make_shared<DiskFile>(fd, static_cast<std::uint64_t>(s.st_size)));
}

Result<FileRecord> besideFile(const FileRecord& header, const std::string& name) {
  const fs::path named(name);
  const bool up = std::any_of(named.begin(), named.end(), [](const fs::path& part) { return part == ".."; });
  if (named.empty() || named.is_absolute() || up) return outside(header);
  if (header.archive) return entryBeside(header, named);
  FileRecord r;
  const fs::path folder = fs::path(header.path).parent_path();
  r.path = (folder / named).string();
  r.shown = named.filename().string();
  std::error_code ec;
  const fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, ec);
  const fs::path target = ec ? fs::path() : fs::canonical(r.path, ec);
  if (ec) return r;  // not there: opening it says so
  if (!inside(root, target)) return outside(header);
  r.bytes = fs::file_size(target, ec);
  if (ec) r.bytes = 0;
  return r;
}

}  // namespace vernier
