// SPDX-License-Identifier: GPL-3.0-or-later
// The thread that owns the technique context (GL). Work is run in order; run() waits for its own piece.
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace vernier::app {

class RenderThread {
 public:
  RenderThread() : thread_([this](std::stop_token stop) { loop(stop); }) {}
  ~RenderThread() {
    thread_.request_stop();
    wake_.notify_all();
  }
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  // `work` must not throw.
  void run(const std::function<void()>& work) {
    bool done = false;
    std::unique_lock lock(mutex_);
    queue_.push_back([&] {
      work();
      const std::lock_guard finished(mutex_);
      done = true;
      finished_.notify_all();
    });
    wake_.notify_one();
    finished_.wait(lock, [&] { return done; });
  }

 private:
  void loop(std::stop_token stop) {
    for (;;) {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, stop, [&] { return !queue_.empty(); });
      if (queue_.empty()) return;  // stopped
      const std::function<void()> work = std::move(queue_.front());
      queue_.pop_front();
      lock.unlock();
      work();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::condition_variable finished_;
  std::deque<std::function<void()>> queue_;
  std::jthread thread_;
};

}  // namespace vernier::app
