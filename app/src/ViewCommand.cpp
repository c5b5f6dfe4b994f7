// SPDX-License-Identifier: GPL-3.0-or-later
// vernier view: the window.
#include <filesystem>

#include "Cli.h"
#include "UiLibrary.h"
#include "ViewOptions.h"
#include "WindowCheck.h"

namespace vernier::app {
namespace {

// A mistyped name is told to whoever typed it, before a window comes. What exists but holds nothing that can
// be shown is said in the window, where another input can be dropped.
Result<void> checkInputs(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    std::error_code ec;
    if (std::filesystem::exists(path, ec) || ec) continue;
    return makeError(ErrorCode::FileNotFound, "There is no such file or folder; check the name.",
                     std::filesystem::path(path).lexically_normal().filename().string());
  }
  return {};
}

struct Options {
  std::vector<std::string> inputs;
  double scale = 0;
  std::string size, screenshot;
};

int run(const GlobalOptions& global, const Options& o) {
  const Result<Settings> settings = readSettings(global.flags);
  if (!settings) return report(settings.error());
  if (const Result<void> there = checkInputs(o.inputs); !there) return report(there.error());
  SessionOptions session;
  session.threads = settings->threads;
  session.memory_mb = settings->memory_mb;
  session.pluginFolders = settings->pluginFolders;
  UiStart start;
  start.paths = o.inputs;
  start.session = &session;
  start.scale = o.scale;
  start.screenshot = o.screenshot;
  if (!o.size.empty()) {
    const auto size = parseSize(o.size);
    if (!size) return report(size.error());
    start.width = size->x, start.height = size->y;
  }
  start.notice = !settings->noticeSeen && o.screenshot.empty();
  // Where the home cannot be written the notice comes again next time; nothing else is lost.
  const std::function<std::string()> accepted = []() -> std::string {
    const Result<void> kept = rememberNoticeSeen();
    if (kept) return "";
    const Result<void> folder = checkSettingsFolder();  // as `vernier doctor` says it
    return folder ? kept.error().sentence : folder.error().sentence;
  };
  start.noticeAccepted = &accepted;
  const Result<void> shown = runWindow(start);
  if (shown) return 0;
  // What doctor would say says more than the failure itself.
  const auto& code = shown.error().code;
  if (code == ErrorCode::WindowUnavailable || code == ErrorCode::GlUnavailable)
    if (const auto window = checkWindow(); !window) return report(window.error());
  return report(shown.error());
}

}  // namespace

Command addView(CLI::App& app, GlobalOptions& global) {
  const auto o = std::make_shared<Options>();
  CLI::App* sub = app.add_subcommand("view", "Open the window on studies");
  sub->add_option("INPUT", o->inputs, "Folders or files; more can be dropped on the window");
  sub->add_option("--ui-scale", o->scale, "Size of text and buttons, 1 to 3 (default: the monitor's)")
      ->check(CLI::Range(1.0, 3.0));
  sub->add_option("--window-size", o->size, "Size of the window, WIDTHxHEIGHT (default 1280x800)");
  sub->add_option("--screenshot", o->screenshot, "Write the window as PNG when all is loaded, and end")
      ->group("");
  sub->footer(
      "Examples:\n"
      "  vernier view                       an empty window; drop a folder on it\n"
      "  vernier view STUDY                 opens the largest series, middle slice\n"
      "  vernier view STUDY --ui-scale 2    for screens with many small pixels\n"
      "In the window F1 shows mouse and keys. `vernier doctor` says whether a window can be opened here.");
  return {sub, [&global, o] { return run(global, *o); }};
}

}  // namespace vernier::app
