// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>

#include "../VtkSymbol.h"
#include "VtkPolyData.h"

namespace vernier::surface {
namespace {

constexpr rlim_t kCpuLimit_s = 60;

template <class T>
bool send(int fd, const T* data, std::size_t count) {
  const char* at = reinterpret_cast<const char*>(data);
  for (std::size_t left = count * sizeof(T); left > 0;) {
    const ssize_t n = ::write(fd, at, left);
    if (n <= 0) return false;
    at += n, left -= static_cast<std::size_t>(n);
  }
  return true;
}

template <class T>
bool receive(int fd, T* data, std::size_t count) {
  char* at = reinterpret_cast<char*>(data);
  for (std::size_t left = count * sizeof(T); left > 0;) {
    const ssize_t n = ::read(fd, at, left);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n, left -= static_cast<std::size_t>(n);
  }
  return true;
}

// What crosses the pipe, in both directions alike: counts, then the arrays.
template <class Move, class Data>
bool exchange(Move&& move, Data& d) {
  std::uint64_t counts[5] = {d.error.size(), d.xyz.size(), d.corners.size(), d.polygonEnds.size(),
                             d.stripEnds.size()};
  if (!move(counts, 5)) return false;
  d.error.resize(counts[0]), d.xyz.resize(counts[1]), d.corners.resize(counts[2]);
  d.polygonEnds.resize(counts[3]), d.stripEnds.resize(counts[4]);
  return move(d.error.data(), d.error.size()) && move(d.xyz.data(), d.xyz.size()) &&
         move(d.corners.data(), d.corners.size()) && move(d.polygonEnds.data(), d.polygonEnds.size()) &&
         move(d.stripEnds.data(), d.stripEnds.size());
}

[[noreturn]] void readInChild(VtkReadFn* read, std::string_view bytes, int fd) {
  const rlimit cpu{kCpuLimit_s, kCpuLimit_s};
  ::setrlimit(RLIMIT_CPU, &cpu);
  const rlimit noCore{0, 0};
  ::setrlimit(RLIMIT_CORE, &noCore);
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE}) ::signal(signal, SIG_DFL);
  VtkPolyData out;
  read(bytes.data(), bytes.size(), &out);
  ::_exit(exchange([fd](const auto* data, std::size_t n) { return send(fd, data, n); }, out) ? 0 : 1);
}

}  // namespace

// VTK 9.1's reader runs past its arrays on files that are damaged in the right places, so it works in a child
// process: whatever happens there is a sentence here.
Result<VtkPolyData> readVtpBytes(std::string_view bytes) {
  auto* const read = reinterpret_cast<VtkReadFn*>(vtkSymbol(kVtkReadName));
  if (!read)
    return makeError(
        ErrorCode::FormatUnknown,
        "Reading VTP needs VTK's libraries, which are not here; install Debian's libvtk9.1, or save "
        "the surface as PLY.");
  int pipe[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0)
    return makeError(ErrorCode::OutOfMemory,
                     "The system has no pipe left to read the file through; close other programs.");
  const pid_t child = ::fork();
  if (child == 0) readInChild(read, bytes, pipe[1]);
  ::close(pipe[1]);
  VtkPolyData out;
  const int from = pipe[0];
  const bool whole =
      child > 0 && exchange([from](auto* data, std::size_t n) { return receive(from, data, n); }, out);
  ::close(from);
  int status = 0;
  if (child > 0)
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
  if (!whole || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    return makeError(ErrorCode::FileDamaged, "VTK cannot read the file; it is cut short or damaged.");
  return out;
}

}  // namespace vernier::surface
