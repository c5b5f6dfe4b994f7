// SPDX-License-Identifier: GPL-3.0-or-later
#include "QualityCheck.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "InstallPlace.h"
#include "QaCase.h"

extern char** environ;

namespace vernier::ui {
namespace {
namespace fs = std::filesystem;

// $XDG_DATA_HOME/vernier/qa, or ~/.local/share/vernier/qa; "" where there is no home.
std::string dataFolder() {
  const char* const data = std::getenv("XDG_DATA_HOME");
  if (data && *data == '/') return std::string(data) + "/vernier/qa";
  const char* const home = std::getenv("HOME");
  return home && *home ? std::string(home) + "/.local/share/vernier/qa" : "";
}

std::string utcName() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H-%M-%SZ", &utc);
  return text;
}

// Standard output and standard error of the child come out of `from`.
int spawn(const std::vector<std::string>& words, int& from) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return 0;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  std::vector<char*> argv;
  for (const std::string& w : words) argv.push_back(const_cast<char*>(w.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int failed = ::posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (failed != 0) {
    ::close(ends[0]);
    return 0;
  }
  from = ends[0];
  return child;
}

constexpr int kPassed = 0, kDamaged = 3, kOutOfTolerance = 4;  // exit codes of `vernier qa run`

}  // namespace

QualityCheck::QualityCheck(std::function<void()> wake)
    : wake_(std::move(wake)), program_(app::programFile()) {}

QualityCheck::~QualityCheck() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

void QualityCheck::change(const std::function<void(QualityState&)>& how) {
  {
    const std::lock_guard lock(mutex_);
    how(state_);
  }
  wake_();
}

void QualityCheck::fail(const std::string& sentence) {
  change([&](QualityState& s) { s.phase = QualityState::Phase::Failed, s.sentence = sentence; });
}

QualityState QualityCheck::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void QualityCheck::cancel() {
  const std::lock_guard lock(mutex_);
  if (state_.phase != QualityState::Phase::Running) return;
  cancelled_ = true;
  if (child_ > 0) ::kill(child_, SIGINT);
}

void QualityCheck::start(const std::string& folder) {
  if (state().phase == QualityState::Phase::Running) return;
  if (thread_.joinable()) thread_.join();
  const std::string suite =
      (fs::path(program_).parent_path().parent_path() / "share" / "vernier" / "clinic").string();
  const Result<std::vector<std::string>> cases = app::findQaCases(suite);
  {
    const std::lock_guard lock(mutex_);
    state_ = {}, cancelled_ = false, child_ = 0;
    if (cases) state_.phase = QualityState::Phase::Running, state_.total = static_cast<int>(cases->size());
  }
  if (!cases) return fail("The suite is not beside the program: " + cases.error().sentence);
  const std::string parent = folder.empty() ? dataFolder() : folder;
  if (parent.empty()) return fail("There is no home folder to keep the report in; set XDG_DATA_HOME.");
  thread_ = std::thread([this, suite, report = parent + "/" + utcName()] { run(suite, report); });
}

// "pass  native geometry/ramp-axial", "native: 66 of 66 cases pass", "vernier: gl: case: sentence".
void QualityCheck::takeLine(const std::string& line, std::string& lastCase) {
  char verdict[8], engine[8], name[128];
  if (line.starts_with("vernier: ")) {
    change([&](QualityState& s) { s.sentence = line.substr(9); });
  } else if (line.ends_with(" cases pass")) {
    change([&](QualityState& s) { s.summary.push_back(line); });
  } else if (!line.starts_with(" ") &&
             std::sscanf(line.c_str(), "%7s %7s %127s", verdict, engine, name) == 3) {
    change([&](QualityState& s) {
      s.done += lastCase != name ? 1 : 0;
      if (std::string(verdict) != "pass") s.notPassed.push_back(std::string(engine) + ": " + name);
    });
    lastCase = name;
  }
}

void QualityCheck::run(const std::string& suite, const std::string& report) {
  int from = -1;
  const int child = spawn({program_, "qa", "run", suite, "--out", report}, from);
  if (child == 0) return fail("The check could not be started: the system has no room for another process.");
  {
    const std::lock_guard lock(mutex_);
    child_ = child;
    if (cancelled_) ::kill(child, SIGINT);
  }
  std::string line, lastCase;
  char bytes[4096];
  for (ssize_t n; (n = ::read(from, bytes, sizeof bytes)) > 0;)
    for (const char c : std::string(bytes, static_cast<std::size_t>(n)))
      if (c == '\n')
        takeLine(std::exchange(line, ""), lastCase);
      else
        line += c;
  ::close(from);
  int status = 0;
  ::waitpid(child, &status, 0);
  bool cancelled;
  {
    const std::lock_guard lock(mutex_);
    child_ = 0;
    cancelled = cancelled_;
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  const std::string page = report + "/report.html";
  std::error_code ec;
  if (cancelled) {
    fs::remove_all(report, ec);
    return change([](QualityState& s) { s = {}; });
  }
  if ((code != kPassed && code != kDamaged && code != kOutOfTolerance) || !fs::exists(page, ec)) {
    const std::string said = state().sentence;
    return fail(said.empty() ? "The check ended before its report was written." : said);
  }
  change([&](QualityState& s) { s.phase = QualityState::Phase::Finished, s.report = page; });
}

}  // namespace vernier::ui
