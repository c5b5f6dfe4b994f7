// SPDX-License-Identifier: GPL-3.0-or-later
#include <clocale>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "Cli.h"
#include "OptionChecks.h"
#include "Version.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Trace.h"

namespace vernier::app {
namespace {

struct Later {
  const char* name;
  const char* what;
};
// Commands of DESIGN's contract whose rooms are not built yet: they say so and exit 1.
constexpr Later kLater[] = {
    {"tradeoff", "sweeps techniques and settings on your volume: time against error"},
    {"export", "writes pictures and series as DICOM"},
    {"anonymise", "removes identifying values from a study"},
};

int notBuiltYet(const Later& command) {
  return report(makeError(ErrorCode::NotBuiltYet,
                          "This command is not built yet; `vernier --help` lists those that are.",
                          command.name));
}

// The trace is written at the end, when it is too late to ask: a file that is there and is no trace is kept.
Result<void> traceMayBeWritten(const std::string& path) {
  std::error_code none;
  if (path.empty() || !std::filesystem::is_regular_file(path, none) ||
      std::filesystem::file_size(path, none) == 0)
    return {};
  const std::string begins = "{\"traceEvents\"";
  std::string found(begins.size(), '\0');
  std::ifstream(path, std::ios::binary).read(found.data(), static_cast<std::streamsize>(found.size()));
  if (found == begins) return {};
  return makeError(ErrorCode::OptionInvalid,
                   "The file is there already and is no trace, so it is kept; name another.", "--trace");
}

int runCli(int argc, char** argv) {
  CLI::App app(
      std::string("Vernier ") + kVersion +
      ": clinical review of volume images (CT, MR, angiography), each picture with its measured error.\n"
      "Not a medical device; not for primary diagnosis.");
  app.name("vernier");
  app.set_version_flag("--version", std::string("vernier ") + kVersion + "\nnot for primary diagnosis");
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(
      "Examples:\n"
      "  vernier view STUDY                          the window\n"
      "  vernier info STUDY                          what is in a folder of DICOM files\n"
      "  vernier render STUDY --view axial --out a.png\n"
      "  vernier phantom small-ct --out study        a synthetic study to try things on\n"
      "`vernier COMMAND --help` tells more of each.");
  GlobalOptions global;
  app.add_option("--threads", global.flags.threads, "Threads to use (0 = all cores)")
      ->check(CLI::Range(0, 1024));
  app.add_option("--plugins", global.flags.pluginFolders, "Another folder to load plugins from (repeatable)");
  app.add_option("--trace", global.traceFile, "Write spans of the work in Chrome's trace format");
  app.add_flag("--quiet", global.quiet, "No progress on the terminal");

  std::vector<Command> commands = {addView(app, global),    addInfo(app, global),    addRender(app, global),
                                   addSheet(app, global),   addBench(app, global),   addCompare(app, global),
                                   addMeasure(app, global), addPhantom(app, global), addDoctor(app, global),
                                   addPlugins(app, global), addQa(app, global)};
  std::vector<Command> notYet;
  for (const Later& later : kLater) {
    CLI::App* sub = app.add_subcommand(later.name, std::string(later.what) + " (not built yet)");
    notYet.push_back({sub, [&later] { return notBuiltYet(later); }});
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
    for (const Command& c : notYet)                  // its options are not known yet, so none is wrong
      if (c.app->parsed()) return c.run();
    if (const std::vector<std::string> rest = app.remaining(); app.get_subcommands().empty() && !rest.empty())
      return report(makeError(ErrorCode::OptionInvalid,
                              "There is no such command or option; `vernier --help` lists them.",
                              rest.front()));
    std::cerr << "vernier: " << e.what() << "; `vernier --help` shows the commands and options.\n";
    return 2;
  }
  for (const CLI::App* parsed : app.get_subcommands())
    if (const Result<void> given = noEmptyValues(*parsed); !given) return report(given.error());
  if (const Result<void> given = noEmptyValues(app); !given) return report(given.error());
  if (const Result<void> free = traceMayBeWritten(global.traceFile); !free) return report(free.error());
  if (!global.traceFile.empty()) traceStart();
  int code = 2;
  commands.insert(commands.end(), notYet.begin(), notYet.end());
  for (const Command& c : commands)
    if (c.app->parsed()) code = c.run();
  // Output that was lost (a full disk, a closed pipe) must not look like success.
  if (!(std::cout.flush() && std::fflush(stdout) == 0) && code == 0)
    code = report(makeError(ErrorCode::WriteFailed,
                            "Standard output could not be written; nothing of it can be relied on."));
  if (!global.traceFile.empty())
    if (const Result<void> written = traceWrite(global.traceFile); !written) return report(written.error());
  return code;
}

}  // namespace
}  // namespace vernier::app

int main(int argc, char** argv) {
  std::setlocale(LC_ALL, "C");
  const auto code =
      vernier::guarded("", [&]() -> vernier::Result<int> { return vernier::app::runCli(argc, argv); });
  return code ? *code : vernier::app::report(code.error());
}
