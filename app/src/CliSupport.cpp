// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <mutex>

#include "Cli.h"
#include "vernier/base/Threads.h"

namespace vernier::app {

int report(const Error& e) {
  std::string text = "vernier: ";
  if (!e.where.empty()) text += e.where + ": ";
  text += e.sentence.empty() ? std::string(generalSentence(e.code)) : e.sentence;
  for (char& c : text)  // one line, whatever a file name holds
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  std::fprintf(stderr, "%s\n", text.c_str());
  return exitCode(e.code);
}

std::unique_ptr<Session> makeSession(const GlobalOptions& global) {
  for (const std::string& folder : global.flags.pluginFolders)
    if (std::error_code ec; !std::filesystem::is_directory(folder, ec)) {
      (void)report(makeError(ErrorCode::OptionInvalid,
                             "One of the folders is not there; name those that hold plugins.", "--plugins"));
      return nullptr;
    }
  const Result<Settings> settings = readSettings(global.flags);
  if (!settings) {
    (void)report(settings.error());
    return nullptr;
  }
  SessionOptions options;
  options.threads = settings->threads;
  options.memory_mb = settings->memory_mb;
  options.pluginFolders = settings->pluginFolders;
  return std::make_unique<Session>(options);
}

ProgressFn terminalProgress(const GlobalOptions& global) {
  if (global.quiet || !::isatty(STDERR_FILENO)) return {};
  struct State {
    std::mutex mutex;
    std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now(), last{};
  };
  return
      [state = std::make_shared<State>()](std::string_view stage, std::uint64_t done, std::uint64_t total) {
        const std::lock_guard lock(state->mutex);
        const auto now = std::chrono::steady_clock::now();
        if (now - state->begin < std::chrono::milliseconds(500)) return;
        if (done < total && now - state->last < std::chrono::milliseconds(100)) return;
        state->last = now;
        std::fprintf(stderr, "\r%.*s %llu/%llu   %s", static_cast<int>(stage.size()), stage.data(),
                     static_cast<unsigned long long>(done), static_cast<unsigned long long>(total),
                     done >= total ? "\n" : "");
      };
}

namespace {
std::stop_source& interruptSource() {
  static std::stop_source source;
  return source;
}
int g_wakePipe[2] = {-1, -1};
}  // namespace

std::stop_token interruptToken() {
  // request_stop() may not be called in a signal handler: a handler writes one byte, a thread does the rest.
  static const bool installed = [] {
    if (::pipe(g_wakePipe) != 0) return false;
    std::thread([] {
      char byte = 0;
      if (::read(g_wakePipe[0], &byte, 1) == 1) interruptSource().request_stop();
    }).detach();
    struct sigaction action {};
    action.sa_handler = [](int) {
      std::signal(SIGINT, SIG_DFL);
      const char byte = 1;
      if (::write(g_wakePipe[1], &byte, 1) < 0) std::_Exit(130);
    };
    return ::sigaction(SIGINT, &action, nullptr) == 0;
  }();
  (void)installed;
  return interruptSource().get_token();
}

}  // namespace vernier::app
