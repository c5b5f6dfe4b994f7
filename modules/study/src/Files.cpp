// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/study/Files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

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

bool inside(const fs::path& folder, const fs::path& target) {
  const auto [f, t] = std::mismatch(folder.begin(), folder.end(), target.begin(), target.end());
  return f == folder.end();
}

Error outside(const FileRecord& header) {
  return makeError(ErrorCode::FileDamaged,
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
  // O_NONBLOCK: opening a pipe must not wait for its other end.
  const int fd = ::open(file.path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd < 0)
    return makeError(ErrorCode::FileNotFound,
                     "The file cannot be opened; check that it is still there and that you may read it.",
                     file.shown);
  struct stat s {};
  if (::fstat(fd, &s) != 0 || !S_ISREG(s.st_mode)) {
    ::close(fd);
    return makeError(ErrorCode::NotAFile, "This is a folder, device, pipe or socket, not a file.", file.shown);
  }
  return std::shared_ptr<const InputFile>(
      std::make_shared<DiskFile>(fd, static_cast<std::uint64_t>(s.st_size)));
}

Result<FileRecord> besideFile(const FileRecord& header, const std::string& name) {
  const fs::path named(name);
  const bool up = std::any_of(named.begin(), named.end(), [](const fs::path& part) { return part == ".."; });
  if (named.empty() || named.is_absolute() || up) return outside(header);
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
