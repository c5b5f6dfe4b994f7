// SPDX-License-Identifier: GPL-3.0-or-later
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <filesystem>

#include "VtkPolyData.h"

namespace vernier::surface {
namespace {

// Beside what this code was linked into, as installed; below it, or beside it, as built.
std::vector<std::filesystem::path> places() {
  static const char here = 0;
  Dl_info info{};
  if (::dladdr(&here, &info) == 0 || !info.dli_fname) return {};
  const std::filesystem::path folder = std::filesystem::absolute(info.dli_fname).parent_path();
  return {folder / kVtkLibrary, folder / "vernier" / kVtkLibrary,
          folder.parent_path() / "lib" / "vernier" / kVtkLibrary};
}

// Loaded once, never closed: VTK keeps objects of its own until the program ends.
VtkReadFn* reader() {
  static VtkReadFn* const found = []() -> VtkReadFn* {
    for (const std::filesystem::path& path : places())
      if (void* library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL))
        return reinterpret_cast<VtkReadFn*>(::dlsym(library, kVtkReadName));
    return nullptr;
  }();
  return found;
}

// VTK 9.1 trusts the sizes of a damaged file and may end the program (its compressed blocks). So it reads in
// a process of its own, and whatever happens there is an error here. What it read comes back through a pipe:
// each list as its length and its numbers.
constexpr rlim_t kMostSeconds = 60;

bool writeAll(int fd, const void* from, std::size_t bytes) {
  const char* at = static_cast<const char*>(from);
  while (bytes > 0) {
    const ssize_t n = ::write(fd, at, bytes);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}

bool readAll(int fd, void* to, std::size_t bytes) {
  char* at = static_cast<char*>(to);
  while (bytes > 0) {
    const ssize_t n = ::read(fd, at, bytes);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}

template <class List>
bool send(int fd, const List& list) {
  const std::uint64_t n = list.size();
  return writeAll(fd, &n, sizeof n) && writeAll(fd, list.data(), n * sizeof(typename List::value_type));
}

// Grows as the numbers come: the length alone sets nothing aside.
template <class List>
bool receive(int fd, List& list) {
  constexpr std::uint64_t piece = 1 << 16;
  std::uint64_t n = 0;
  if (!readAll(fd, &n, sizeof n)) return false;
  while (list.size() < n) {
    const std::size_t at = list.size(), more = static_cast<std::size_t>(std::min(piece, n - at));
    list.resize(at + more);
    if (!readAll(fd, list.data() + at, more * sizeof(typename List::value_type))) return false;
  }
  return true;
}

[[noreturn]] void readInChild(VtkReadFn* readVtp, std::string_view bytes, int fd) {
  const rlimit seconds{kMostSeconds, kMostSeconds}, noCore{0, 0};
  ::setrlimit(RLIMIT_CPU, &seconds);
  ::setrlimit(RLIMIT_CORE, &noCore);
  for (const int fatal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(fatal, SIG_DFL);
  int result = 1;
  try {
    VtkPolyData out;
    readVtp(bytes.data(), bytes.size(), &out);
    if (send(fd, out.error) && send(fd, out.xyz) && send(fd, out.corners) && send(fd, out.polygonEnds) &&
        send(fd, out.stripEnds))
      result = 0;
  } catch (...) {
    result = 1;  // out of memory, most likely: the parent says that the file cannot be read
  }
  ::_exit(result);
}

}  // namespace

Result<VtkPolyData> readVtpBytes(std::string_view bytes) {
  VtkReadFn* const readVtp = reader();
  if (!readVtp)
    return makeError(
        ErrorCode::FormatUnknown,
        "Reading VTP needs VTK's libraries, which are not here; install Debian's libvtk9.1, or save "
        "the surface as PLY.");
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    return makeError(ErrorCode::OutOfMemory, "There is no pipe left to read the file through.");
  const pid_t child = ::fork();
  if (child == 0) readInChild(readVtp, bytes, ends[1]);
  ::close(ends[1]);
  VtkPolyData out;
  const bool whole = child > 0 && receive(ends[0], out.error) && receive(ends[0], out.xyz) &&
                     receive(ends[0], out.corners) && receive(ends[0], out.polygonEnds) &&
                     receive(ends[0], out.stripEnds);
  ::close(ends[0]);
  if (child < 0) return makeError(ErrorCode::OutOfMemory, "There is no process left to read the file with.");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!whole || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    out = {};
    out.error = "the reader ended early";
  }
  return out;
}

}  // namespace vernier::surface
