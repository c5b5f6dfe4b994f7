// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/base/Trace.h"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace vernier {
namespace {
struct Span {
  const char* name;
  std::int64_t begin_us, end_us;
  std::size_t thread;
};
std::atomic<bool> g_on{false};
std::mutex g_mutex;
std::vector<Span> g_spans;

std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
}  // namespace

void traceStart() {
  const std::lock_guard lock(g_mutex);
  g_spans.clear();
  g_on = true;
}

Result<void> traceWrite(const std::string& path) {
  const std::lock_guard lock(g_mutex);
  std::FILE* f = std::fopen(path.c_str(), "w");
  if (!f) return makeError(ErrorCode::WriteFailed, "The trace cannot be written there.", path);
  std::fputs("{\"traceEvents\":[", f);
  bool first = true;
  for (const Span& s : g_spans) {
    std::fprintf(f, "%s\n{\"name\":\"%s\",\"ph\":\"X\",\"pid\":1,\"tid\":%zu,\"ts\":%lld,\"dur\":%lld}",
                 first ? "" : ",", s.name, s.thread % 100000, static_cast<long long>(s.begin_us),
                 static_cast<long long>(s.end_us - s.begin_us));
    first = false;
  }
  std::fputs("\n]}\n", f);
  const bool bad = std::ferror(f) != 0;
  if (std::fclose(f) != 0 || bad)
    return makeError(ErrorCode::WriteFailed, "The trace was not written whole.", path);
  return {};
}

TraceSpan::TraceSpan(const char* name) : name_(name), begin_us_(g_on ? now_us() : -1) {}
TraceSpan::~TraceSpan() {
  if (begin_us_ < 0) return;
  const Span s{name_, begin_us_, now_us(), std::hash<std::thread::id>{}(std::this_thread::get_id())};
  const std::lock_guard lock(g_mutex);
  g_spans.push_back(s);
}

}  // namespace vernier
