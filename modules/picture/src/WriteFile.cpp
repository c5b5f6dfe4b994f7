// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/WriteFile.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace vernier {
namespace {

namespace fs = std::filesystem;

Error failed(const std::string& path, const std::string& why) {
  return makeError(ErrorCode::WriteFailed, "The file cannot be written: " + why + ".", path);
}
std::string reason(int code) { return std::generic_category().message(code); }

// A file under work; gone again unless it was renamed.
struct TempFile {
  std::string path;
  int fd = -1;
  ~TempFile() {
    if (fd >= 0) ::close(fd);
    if (!path.empty()) ::unlink(path.c_str());
  }
};

bool writeAll(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace

Result<void> writeFileWhole(const std::string& path, std::span<const std::byte> bytes) {
  if (path.empty()) return failed(path, "no file name was given");
  std::error_code ec;
  fs::path target(path);
  if (const fs::file_status status = fs::status(target, ec); fs::exists(status)) {
    if (!fs::is_regular_file(status))
      return failed(path, "the name belongs to something that is no regular file");
    target = fs::canonical(target, ec);
    if (ec) return failed(path, ec.message());
  }
  TempFile temp;
  std::string name = (target.parent_path() / (".vernier-" + target.filename().string() + ".XXXXXX")).string();
  temp.fd = ::mkstemp(name.data());
  if (temp.fd < 0) return failed(path, reason(errno));
  temp.path = name;
  // mkstemp makes the file private; the finished one has the rights that any new file would have.
  const mode_t mask = ::umask(0);
  ::umask(mask);
  if (::fchmod(temp.fd, 0666 & ~mask) != 0) return failed(path, reason(errno));
  // On the disk before it takes the old one's name: a machine that stops in between keeps one or the other.
  if (!writeAll(temp.fd, bytes) || ::fsync(temp.fd) != 0) return failed(path, reason(errno));
  const int fd = temp.fd;
  temp.fd = -1;
  if (::close(fd) != 0) return failed(path, reason(errno));
  if (::rename(temp.path.c_str(), target.c_str()) != 0) return failed(path, reason(errno));
  temp.path.clear();
  return {};
}

}  // namespace vernier
