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
  const std::vector<VolumeFile>& volumes = session->volumeFiles();
  info.surfaces = surfacesOf(study, &session->budget(), interruptToken());
  std::cout << (o.json ? infoJson(study, info, volumes) : infoText(study, volumes, info.surfaces))
            << std::flush;
  const bool anyVolume =
      std::any_of(volumes.begin(), volumes.end(), [](const VolumeFile& v) { return v.facts.has_value(); });
  const bool anySurface = std::any_of(info.surfaces.begin(), info.surfaces.end(),
                                      [](const SurfaceRecord& s) { return !s.error.has_value(); });
  if (study.instances.empty() && !anyVolume && !anySurface) {
    if (study.files.size() == 1 && info.surfaces.size() == 1) return report(*info.surfaces[0].error);
    if (study.files.size() == 1 && study.files[0].error) return report(*study.files[0].error);
    return report(makeError(ErrorCode::NothingToLoad,
                            "No DICOM object and no volume file was found among " +
                                std::to_string(study.files.size()) + " files.",
                            nameOf(o.inputs.front())));
  }
  return 0;
}
}  // namespace

Command addInfo(CLI::App& app, GlobalOptions& global) {
  const auto o = std::make_shared<Options>();
  CLI::App* sub =
      app.add_subcommand("info", "Patients, studies, series, geometry, surfaces and findings of an input");
  sub->add_option("INPUT", o->inputs, "Files, folders or ZIP archives (docs/files.md)")->required();
  sub->add_flag("--json", o->json, "JSON on standard output");
  sub->add_flag("--pixels", o->pixels, "Decode all images too: SHA-256, extrema, probes (JSON only)");
  sub->footer(
      "Examples:\n  vernier info STUDY\n  vernier info study.zip\n  vernier info T1.nii.gz\n  vernier info "
      "/media/cdrom/DICOMDIR\n  vernier info screw.stl\n  vernier info STUDY --json --pixels > facts.json");
  return {sub, [&global, o] { return run(global, *o); }};
}

}  // namespace vernier::app
