// SPDX-License-Identifier: GPL-3.0-or-later
// QualityCheck: runs the suite that comes with the program (docs/qa.md) beside the window. The work is done
// by another process of the same program, so that a graphics driver that fails takes nothing of the window
// along.
//
// Threads: all functions from the window's thread; `wake` is called from another one when the state changes.
#pragma once
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace vernier::ui {

struct QualityState {
  enum class Phase {
    Idle,
    Running,
    Finished,  // notPassed and report say how
    Failed,    // `sentence` says why
  };
  Phase phase = Phase::Idle;
  int done = 0, total = 0;             // cases
  std::vector<std::string> notPassed;  // "gl: geometry/ramp-axial"
  std::vector<std::string> summary;    // "native: 66 of 66 cases pass"
  std::string report;                  // report.html
  std::string sentence;
};

class QualityCheck {
 public:
  explicit QualityCheck(std::function<void()> wake);
  ~QualityCheck();  // ends what runs
  QualityCheck(const QualityCheck&) = delete;
  QualityCheck& operator=(const QualityCheck&) = delete;

  // vernier, with its suite beside it; at first the running program.
  void useProgram(std::string program) { program_ = std::move(program); }
  // The report goes to a new folder below `folder`, named after the time (UTC); "": below the user's data
  // folder. Nothing is done while a run goes on.
  void start(const std::string& folder = "");
  void cancel();
  QualityState state() const;

 private:
  void run(const std::string& suite, const std::string& report);
  void takeLine(const std::string&, std::string& lastCase);
  void fail(const std::string& sentence);
  void change(const std::function<void(QualityState&)>&);

  std::function<void()> wake_;
  std::string program_;
  mutable std::mutex mutex_;  // of state_, child_ and cancelled_
  QualityState state_;
  int child_ = 0;
  bool cancelled_ = false;
  std::thread thread_;
};

}  // namespace vernier::ui
