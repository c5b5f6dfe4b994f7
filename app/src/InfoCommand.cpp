// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "Cli.h"
#include "InfoJson.h"

namespace vernier::app {
namespace {
struct Options {
  std::vector<std::string> inputs;
  bool json = false;
  bool pixels = false;
};

// The last part of what the user named, also of "folder/": errors never carry a whole path.
std::string nameOf(const std::string& input) {
  const std::filesystem::path path(input);
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

int run(const GlobalOptions& global, const Options& o) {
  const auto session = makeSession(global);
  if (!session) return 2;
  if (const Result<void> opened = session->open(o.inputs, terminalProgress(global), interruptToken());
      !opened)
    return report(opened.error());
  InfoOptions info;
  info.pixels = o.pixels;
  const StudySet& study = session->study();
  info.surfaces = surfacesOf(study, &session->budget(), interruptToken());
  std::cout << (o.json ? infoJson(study, info) : infoText(study, info.surfaces)) << std::flush;
  const auto isRead = [](const SurfaceRecord& s) { return !s.error.has_value(); };
  if (std::any_of(info.surfaces.begin(), info.surfaces.end(), isRead)) return std::cout.good() ? 0 : 1;
  if (study.instances.empty() && !session->isMetaImage()) {
    if (study.files.size() == 1 && info.surfaces.size() == 1) return report(*info.surfaces[0].error);
    if (study.files.size() == 1 && study.files[0].error) return report(*study.files[0].error);
    return report(makeError(ErrorCode::NothingToLoad,
                            "No DICOM object was found among " + std::to_string(study.files.size()) +
                                " files; a MetaImage is opened by naming its .mhd or .mha file itself.",
                            nameOf(o.inputs.front())));
  }
  return 0;
}
}  // namespace

Command addInfo(CLI::App& app, GlobalOptions& global) {
  const auto o = std::make_shared<Options>();
  CLI::App* sub =
      app.add_subcommand("info", "Patients, studies, series, geometry, surfaces and findings of an input");
  sub->add_option("INPUT", o->inputs, "Files or folders")->required();
  sub->add_flag("--json", o->json, "JSON on standard output");
  sub->add_flag("--pixels", o->pixels, "Decode all images too: SHA-256, extrema, probes (JSON only)");
  sub->footer(
      "Examples:\n  vernier info STUDY\n  vernier info STUDY --json --pixels > facts.json\n  vernier info "
      "screw.stl");
  return {sub, [&global, o] { return run(global, *o); }};
}

}  // namespace vernier::app
