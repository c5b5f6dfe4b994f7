// SPDX-License-Identifier: GPL-3.0-or-later
// LoadService: one thread that opens inputs, builds volumes and makes thumbnails, in this order of
// importance. Each opened input has a Session of its own, handed over when it has been read. What is asked
// for twice is done once.
//
// Threads: all functions from any thread. `wake` is called from the service's threads when something is
// ready and, at most ten times a second, when progress has been made.
#pragma once
#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "SourceFacts.h"
#include "vernier/picture/Picture.h"

namespace vernier::ui {

inline constexpr int kThumbnail_px = 144;

struct Opened {
  int document = 0;
  std::vector<std::string> paths;
  std::shared_ptr<app::Session> session;  // nullptr with `error`
  std::optional<Error> error;
};
struct BuiltVolume {
  SourceId source;
  std::shared_ptr<const Volume> volume;
  std::optional<Error> error;
};
struct Thumbnail {
  SourceId source;
  Picture rgba;  // empty with `error`
  std::optional<Error> error;
};
// What is being done, for the bar.
struct LoadProgress {
  bool opening = false;
  SourceId source;    // of a volume
  std::string stage;  // "reading headers"
  std::uint64_t done = 0, total = 0;
};

class LoadService {
 public:
  LoadService(app::SessionOptions, std::function<void()> wake);
  ~LoadService();  // cancels what runs and waits for it
  LoadService(const LoadService&) = delete;
  LoadService& operator=(const LoadService&) = delete;

  int open(std::vector<std::string> paths);  // the number of the document to come
  void build(SourceId, std::shared_ptr<app::Session>);
  void thumbnail(SourceId, std::shared_ptr<app::Session>);
  void cancel();              // what is opened or built now, and what waits to be
  void forget(int document);  // nothing of it comes after this, but what is ready already

  struct Ready {
    std::vector<Opened> opened;
    std::vector<BuiltVolume> volumes;
    std::vector<Thumbnail> thumbnails;
  };
  Ready take();
  std::optional<LoadProgress> progress() const;  // nullopt when nothing is opened or built
  bool idle() const;

 private:
  enum class Kind { Open, Volume, Thumbnail };
  struct Job {
    Kind kind;
    SourceId source;  // document only, for Open
    std::vector<std::string> paths;
    std::shared_ptr<app::Session> session;
  };
  void add(Job);
  void loop(std::stop_token);
  void run(const Job&, std::stop_token);
  void advance(std::string_view stage, std::uint64_t done, std::uint64_t total);

  const app::SessionOptions options_;
  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Job> jobs_;
  std::optional<Job> current_;
  std::stop_source stopCurrent_;
  LoadProgress progress_;
  std::chrono::steady_clock::time_point lastWake_{};
  Ready ready_;
  int documents_ = 0;
  std::jthread thread_;
};

}  // namespace vernier::ui
