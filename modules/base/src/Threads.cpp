// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/base/Threads.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>

namespace vernier {
namespace {
std::mutex g_mutex;
std::unique_ptr<tbb::global_control> g_control;
int g_threads = 0;
}  // namespace

void setThreads(int n) {
  const std::lock_guard lock(g_mutex);
  const int cores = tbb::info::default_concurrency();
  g_threads = n > 0 ? n : cores;
  g_control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(g_threads));
  setenv("LP_NUM_THREADS", std::to_string(g_threads).c_str(), 1);
}

int threads() {
  const std::lock_guard lock(g_mutex);
  return g_threads > 0 ? g_threads : tbb::info::default_concurrency();
}

void parallelFor(std::size_t n, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)>& body) {
  if (n == 0) return;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, n, grain > 0 ? grain : 1),
      [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); }, tbb::simple_partitioner());
}

}  // namespace vernier
