// SPDX-License-Identifier: GPL-3.0-or-later
// The command line: one file per subcommand, each adding itself to the CLI11 app and leaving a function that
// runs it.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "Session.h"
#include "Settings.h"

namespace vernier::app {

// Options that every command has; values as given.
struct GlobalOptions {
  SettingFlags flags;
  std::string traceFile;
  bool quiet = false;
};

using Run = std::function<int()>;
// Adds a subcommand; `run` is called when it was chosen.
struct Command {
  CLI::App* app = nullptr;
  Run run;
};

Command addInfo(CLI::App&, GlobalOptions&);
Command addRender(CLI::App&, GlobalOptions&);
Command addBench(CLI::App&, GlobalOptions&);
Command addSheet(CLI::App&, GlobalOptions&);
Command addCompare(CLI::App&, GlobalOptions&);
Command addMeasure(CLI::App&, GlobalOptions&);
Command addPhantom(CLI::App&, GlobalOptions&);
Command addDoctor(CLI::App&, GlobalOptions&);
Command addView(CLI::App&, GlobalOptions&);
Command addPlugins(CLI::App&, GlobalOptions&);
Command addQa(CLI::App&, GlobalOptions&);

// "vernier: where: sentence" on stderr; returns the exit code.
int report(const Error&);
// Makes a session from settings and flags; reports and returns nullptr when they are wrong (exit 2).
std::unique_ptr<Session> makeSession(const GlobalOptions&);
// Progress on stderr when that is a terminal and the work takes over half a second, else nothing.
ProgressFn terminalProgress(const GlobalOptions&);
// Stops when the user interrupts (SIGINT); the second interrupt kills.
std::stop_token interruptToken();

}  // namespace vernier::app
